/// Depth of footage in metres, from depth maps as renderers, stereo matchers and networks write them.
///
/// What a stored value v means:
///   DepthType::Z        metres along the axis            with a range: NEAR + v (FAR - NEAR)
///   DepthType::Ray      metres along the pixel's ray     with a range: the same
///   DepthType::Inverse  1/metres along the axis          with a range: 1/metres = 1/FAR + v (1/NEAR - 1/FAR)
/// With a range, v is the file's code range: integers 0…1 of their largest code, floats as they are.
///
/// Background, hence `far`: NaN, infinity, kInfiniteDepth metres and beyond (some renderers' "nothing there"), zero in
/// inverse depth, zero metres in the other types without a range, and pixels outside the map's data window. Results are
/// limited to kNearestDepth or more; so they are always finite and positive.
///
/// Remarks: pixels of zero metres; with a range, floats outside 0…1, which lie beyond NEAR and FAR.
///
/// Errors. UserError: an unknown channel, integers without a range (a code is no length), a range that is not finite,
/// negative, empty, or for inverse depth zero. FrameError: a negative depth (with the count), no depth at all (nothing
/// but zeros and NaN), another size than the footage's, an unreadable file.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "warp/image/picture.h"
#include "warp/image/plane.h"
#include "warp/pixels/depth_range.h"

namespace eikonal {

enum class DepthType { Z, Ray, Inverse };

struct DepthOptions {
    std::string channel;  ///< empty: Z, depth.Z, depth, else the only channel, else grey colour
    DepthType type = DepthType::Z;
    std::optional<std::array<double, 2>> range;  ///< NEAR, FAR [m]; NEAR may be the larger
    double far = kDefaultFar;                    ///< of the background [m] > 0
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

/// The same from a picture already read, such as the footage itself; `file` stands in messages.
DepthBuffer depth_from_picture(const Picture& picture, const std::filesystem::path& file, const DepthOptions& options,
                               const PixelWindow& data, const PixelWindow& display);

/// Throws the UserErrors above that need no file.
void check_depth_options(const DepthOptions& options);

}  // namespace eikonal
