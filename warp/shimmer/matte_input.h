/// The matte of each frame, read from files. It scales the displacement of each pixel.
#pragma once

#include <string>
#include <vector>

#include "warp/image/plane.h"
#include "warp/image/sequence.h"

namespace eikonal {

/// Immutable, thread-safe.
class MatteInput {
  public:
    /// UserError: FILE[:CHANNEL] names no file, or a movie.
    explicit MatteInput(const std::string& file_and_channel);

    const FilePattern& files() const { return files_; }
    /// Values 0 … 1 on the pixels `data` (plane.h). Remarks on the file are added to `remarks`. FrameError: unreadable.
    std::vector<float> at(int frame, const PixelWindow& data, const PixelWindow& display,
                          std::vector<Remark>& remarks) const;

  private:
    FilePattern files_;
    std::string channel_;
};

}  // namespace eikonal
