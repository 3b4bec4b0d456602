/// One channel of a picture as numbers on the pixels of footage. Depth maps and mattes use it.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "warp/image/picture.h"

namespace eikonal {

/// A channel's values: codes without transfer curve. Integers count as 0…1 of their range. Infinity and NaN are kept.
struct Plane {
    PixelWindow window;         ///< the window that was asked for
    std::vector<float> values;  ///< window.area()
    std::string channel;        ///< the name found
    bool integer = false;       ///< the file stores integers
    PixelWindow held;           ///< the part of `window` that the file has pixels for
};

/// Something that the user should know about a file that is accepted. A run tells it once for each `about`.
struct Remark {
    std::string_view about;  ///< a literal
    std::string text;
    bool warning = true;  ///< false: only of interest to a user who asks
};

/// Least and greatest of the finite values; {0, 0} if there is none.
std::array<float, 2> finite_range(std::span<const float> values);

/// Finds `channel` in the parts of a picture and lays it over the pixels `data` of footage whose display window is
/// `display`. The name matches exactly, or else without regard to case. It may be PART.CHANNEL. The picture's display
/// window must have the size of `display`, or its data window the size of `data`. Pixels that it lacks get `outside`.
///
/// If `channel` is empty, the first of these is taken: a name of `preferred`, the channel of a single-channel picture,
/// a main colour layer that is grey (equal R, G, B everywhere). file: its name in messages. UserError if there is no
/// such channel; the message lists all channels. FrameError for another size; the message names both.
Plane take_plane(const Picture& picture, const std::filesystem::path& file, std::string_view channel,
                 std::span<const std::string_view> preferred, const PixelWindow& data, const PixelWindow& display,
                 float outside);

/// Reads a matte from a file in the same way. If `channel` is empty, it is alpha unless that is 1 everywhere, else the
/// grey picture. Values are limited to 0…1. NaN and pixels that the file lacks are 0. Remarks go to `remarks`, unless
/// it is null: matte_codes for values outside 0…1 or NaN, and matte_channel for the choice among several channels.
std::vector<float> read_matte(const std::filesystem::path& file, const std::string& channel, const PixelWindow& data,
                              const PixelWindow& display, std::vector<Remark>* remarks = nullptr);

}  // namespace eikonal
