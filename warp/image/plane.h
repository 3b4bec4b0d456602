/// One channel of a picture as numbers on the footage's pixels: what depth maps and mattes have in common.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "warp/image/picture.h"

namespace eikonal {

/// A channel's values, codes without transfer curve (integers 0…1 of their range), infinity and NaN as stored.
struct Plane {
    PixelWindow window;         ///< as asked for
    std::vector<float> values;  ///< window.area()
    std::string channel;        ///< the name found
    bool integer = false;       ///< the file stores integers
    PixelWindow held;           ///< the part of `window` that the file has pixels for
};

/// What the user should know of a file that is read all the same, to be told once a run for each `about`.
struct Remark {
    std::string_view about;  ///< a literal
    std::string text;
    bool warning = true;  ///< else of interest only to who asks
};

/// Least and greatest of the finite values; {0, 0} if there is none.
std::array<float, 2> finite_range(std::span<const float> values);

/// Finds `channel` in the parts of a picture (exact, then ignoring case; also as PART.CHANNEL) and lays it over the
/// pixels `data` of footage whose display window is `display`. The picture's display window must have the footage's
/// size, or its pixels the size of `data`; what its own data window lacks is `outside`.
///
/// An empty `channel` looks for `preferred` in turn, then a single-channel picture, then a main colour layer that is
/// grey (equal R, G, B everywhere). `file` stands in messages. UserError: no such channel (lists what there is).
/// FrameError: another size (names both).
Plane take_plane(const Picture& picture, const std::filesystem::path& file, std::string_view channel,
                 std::span<const std::string_view> preferred, const PixelWindow& data, const PixelWindow& display,
                 float outside);

/// A matte from a file on the same terms: channel given, or alpha unless it is 1 everywhere, or the grey picture.
/// Values limited to 0…1, NaN and pixels the file lacks are 0. Remarks: matte_codes, values outside 0…1 or NaN;
/// matte_channel, which of several is taken (no warning); they are added to `remarks`, if there is such.
std::vector<float> read_matte(const std::filesystem::path& file, const std::string& channel, const PixelWindow& data,
                              const PixelWindow& display, std::vector<Remark>* remarks = nullptr);

}  // namespace eikonal
