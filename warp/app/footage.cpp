#include "warp/app/footage.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "noise/base/error.h"
#include "warp/shimmer/depth_input.h"

namespace eikonal {
namespace {

int bits_of(const Part& part) {
    const auto base = part.spec.format.basetype;
    if (base == OIIO::TypeDesc::HALF) return 16;
    const int stored = part.spec.get_int_attribute("oiio:BitsPerSample", static_cast<int>(8 * part.spec.format.size()));
    return std::clamp(stored, 8, 32);
}

void describe_picture(const Picture& header, Footage& footage) {
    const Part& part = header.parts.front();
    footage.display = display_window(part);
    footage.pixel_aspect = pixel_aspect(part);
    footage.source_bits = bits_of(part);
    footage.channels = 0;
    for (const Part& each : header.parts) footage.channels += each.spec.nchannels;
    footage.has_alpha =
        std::any_of(part.kinds.begin(), part.kinds.end(), [](ChannelKind k) { return k == ChannelKind::Alpha; });
    if (const auto* rate = part.spec.find_attribute("FramesPerSecond", OIIO::TypeRational)) {
        const int* r = static_cast<const int*>(rate->data());
        if (r[0] > 0 && r[1] > 0) footage.fps = Rational{r[0], r[1]};
    } else if (const float fps = part.spec.get_float_attribute("FramesPerSecond"); fps > 0) {
        footage.fps = Rational{static_cast<std::int64_t>(fps * 1000 + 0.5f), 1000};
    }
}

void describe_movie(const std::filesystem::path& file, Footage& footage) {
    const MovieReader reader(file);
    const MovieFormat& format = reader.format();
    footage.display = {0, 0, format.width, format.height};
    footage.pixel_aspect = format.pixel_aspect;
    footage.source_bits = format.depth;
    footage.has_alpha = format.alpha;
    if (reader.fps().num > 0) footage.fps = reader.fps();
    if (const auto count = reader.frame_count()) {
        footage.frames.resize(static_cast<std::size_t>(*count));
        std::iota(footage.frames.begin(), footage.frames.end(), 1);
        footage.count_is_exact = reader.count_is_exact();
    }
    if (reader.interlaced())
        footage.notes.push_back(
            fmt::format("'{}' is interlaced: its rows belong to two instants; deinterlace it first (ffmpeg -vf yadif)",
                        file.string()));
    if (reader.rotation() != 0)
        footage.notes.push_back(
            fmt::format("'{}' is stored turned by {} degrees; the air moves in the picture as stored", file.string(),
                        reader.rotation()));
}

}  // namespace

FootageKind footage_kind(const std::filesystem::path& path) {
    if (is_movie(path)) return FootageKind::Movie;
    return FilePattern::parse(path).is_sequence() ? FootageKind::Sequence : FootageKind::Still;
}

Picture first_header(const FilePattern& files, const std::vector<int>& frames) {
    std::optional<FrameError> failure;
    for (const int frame : frames) {
        try {
            return read_picture_header(files.at(frame));
        } catch (const FrameError& error) {
            if (!failure) failure.emplace(fmt::format("frame {}: {}", frame, error.what()));
        }
    }
    throw FrameError(*failure);
}

PixelWindow pixels_of(const Footage& footage) {
    int left = 0, top = 0, right = footage.display.width, bottom = footage.display.height;
    std::vector<int> frames = footage.frames;
    if (footage.kind == FootageKind::Movie) frames.clear();
    if (footage.kind == FootageKind::Still) frames.assign(1, 1);
    for (const int frame : frames) {
        try {
            const Part part = read_picture_header(footage.files.at(frame)).parts.front();
            const PixelWindow data = seen_from(data_window(part), display_window(part));
            left = std::min(left, data.x0);
            top = std::min(top, data.y0);
            right = std::max(right, data.x0 + data.width);
            bottom = std::max(bottom, data.y0 + data.height);
        } catch (const FrameError&) {
            // The error is reported when the frame's turn comes.
        }
    }
    return {left, top, right - left, bottom - top};
}

Footage find_footage(const std::filesystem::path& path, const std::vector<int>& wanted, int still) {
    Footage footage;
    footage.files = FilePattern::parse(path);
    footage.kind = footage_kind(path);
    if (path.empty()) throw UserError("INPUT: '' is no file name");
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        throw UserError(fmt::format("'{}' is a folder; name the files in it, e.g. '{}'", path.string(),
                                    (path / "plate.####.exr").string()));
    if (footage.kind == FootageKind::Movie) {
        describe_movie(path, footage);
        return footage;
    }
    if (footage.kind == FootageKind::Still) {
        describe_picture(first_header(footage.files, {wanted.empty() ? still : wanted.front()}), footage);
        return footage;
    }
    footage.frames = footage.files.find_frames();
    if (footage.frames.empty()) throw FrameError(fmt::format("no file matches '{}'", path.string()));
    // A damaged first frame must not hide the others.
    describe_picture(first_header(footage.files, wanted.empty() ? footage.frames : wanted), footage);
    return footage;
}

std::vector<int> missing_frames(const std::vector<int>& frames) {
    if (frames.size() < 3) return {};
    int step = std::numeric_limits<int>::max();
    for (std::size_t i = 1; i < frames.size(); ++i) step = std::min(step, frames[i] - frames[i - 1]);
    std::vector<int> missing;
    for (std::size_t i = 1; i < frames.size(); ++i)
        for (long f = static_cast<long>(frames[i - 1]) + step; f < frames[i] && missing.size() < 1000; f += step)
            missing.push_back(static_cast<int>(f));
    return missing;
}

std::string frame_list(const std::vector<int>& frames) {
    constexpr std::size_t kShown = 6;
    std::string text;
    for (std::size_t i = 0; i < std::min(frames.size(), kShown); ++i)
        text += fmt::format("{}{}", i == 0 ? "" : ", ", frames[i]);
    if (frames.size() > kShown) text += fmt::format(" … ({} in all)", frames.size());
    return text;
}

}  // namespace eikonal
