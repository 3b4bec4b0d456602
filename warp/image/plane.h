/// One channel of a picture as numbers on the footage's pixels: what depth maps and mattes have in common.
#pragma once

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
};

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
/// Values limited to 0…1, NaN and pixels the file lacks are 0.
std::vector<float> read_matte(const std::filesystem::path& file, const std::string& channel, const PixelWindow& data,
                              const PixelWindow& display);

}  // namespace eikonal
