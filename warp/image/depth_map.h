/// Depth of footage in metres, from depth maps of renderers, stereo matchers and neural networks.
///
/// Meaning of a stored value v:
///   DepthType::Z        metres along the axis            with a range: NEAR + v (FAR - NEAR)
///   DepthType::Ray      metres along the pixel's ray     with a range: the same
///   DepthType::Inverse  1/metres along the axis          with a range: 1/metres = 1/FAR + v (1/NEAR - 1/FAR)
/// With a range, integer codes count as 0…1 of their largest code, and floats as they are.
///
/// Background takes the depth `far`. It is: NaN, infinity, kInfiniteDepth metres and beyond (some renderers mark empty
/// space so), zero in inverse depth, zero metres in the other types without a range, and pixels outside the map's data
/// window. Results are limited to kNearestDepth or more, so they are always finite and positive.
///
/// Remarks report pixels of zero metres and, with a range, floats outside 0…1, which lie beyond NEAR and FAR.
///
/// Failures. UserError: an unknown channel; integers without a range, since a code is not a length; a range that is not
/// finite, is negative, is empty, or is zero for inverse depth. FrameError: negative depths (with their count), nothing
/// but zeros and NaN, another size than the footage's, an unreadable file.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "warp/image/picture.h"
#include "warp/image/plane.h"
#include "warp/pixels/depth_range.h"

namespace eikonal {

enum class DepthType { Z, Ray, Inverse };

struct DepthOptions {
    std::string channel;  ///< empty: the first of Z, depth.Z, depth, the only channel, grey colour
    DepthType type = DepthType::Z;
    std::optional<std::array<double, 2>> range;  ///< NEAR, FAR [m]. NEAR may be the larger.
    double far = kDefaultFar;                    ///< depth of the background [m] > 0
};

/// Depth of every pixel of a window, finite and positive.
struct DepthBuffer {
    PixelWindow window;
    bool along_ray = false;       ///< metres along each pixel's ray rather than along the axis
    std::vector<float> metres;    ///< window.area(), row by row
    std::vector<Remark> remarks;  ///< about depth_zeros, depth_codes
};

/// Depth on the pixels `data` of footage whose display window is `display`.
DepthBuffer read_depth(const std::filesystem::path& file, const DepthOptions& options, const PixelWindow& data,
                       const PixelWindow& display);

/// The same from a picture that has been read, for example the footage itself. file: its name in messages.
DepthBuffer depth_from_picture(const Picture& picture, const std::filesystem::path& file, const DepthOptions& options,
                               const PixelWindow& data, const PixelWindow& display);

/// The same from values that a caller has, one for each pixel of `window`. name: stands in messages.
DepthBuffer depth_from_values(std::vector<float> values, std::string_view name, const DepthOptions& options,
                              const PixelWindow& window);

/// Throws those UserErrors above that do not need a file.
void check_depth_options(const DepthOptions& options);

}  // namespace eikonal
