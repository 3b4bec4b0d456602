#include "warp/shimmer/matte_input.h"

#include <fmt/format.h>

#include "noise/base/error.h"
#include "warp/shimmer/depth_input.h"

namespace eikonal {

MatteInput::MatteInput(const std::string& file_and_channel) {
    const FileChannel split = split_channel(file_and_channel);
    if (split.file.empty())
        throw UserError(fmt::format("`mask`: '{}' names no file; give FILE or FILE:CHANNEL", file_and_channel));
    refuse_movie("`mask`", split.file, "mask");
    files_ = FilePattern::parse(split.file);
    channel_ = split.channel;
}

std::vector<float> MatteInput::at(int frame, const PixelWindow& data, const PixelWindow& display,
                                  std::vector<Remark>& remarks) const {
    return read_matte(files_.at(frame), channel_, data, display, &remarks);
}

}  // namespace eikonal
