/// The resampler: out(p) = in(p + d(p)) for float pixels, exact in position.
///
/// Positions. The integer part and the fraction of a position are taken from the displacement alone, floor(d) and
/// d - floor(d), never from x + d: a shift of 0.001 px at x = 16000 is as exact as at x = 0. Consequently
///  - A displacement of zero copies the pixel's bits, whatever they hold (-0, NaN, infinities) and whatever surrounds
///    the pixel.
///  - An integer displacement copies the source pixel's bits. `Area` does so only where the map is locally rigid.
///    Elsewhere its footprint is wider than a pixel.
///  - An axis with an integer displacement is not filtered: samples of zero weight are never read.
///
/// Displacements are in pixels, x right, y down, measured between pixel centres. A displacement with a component that
/// is NaN or infinite counts as zero. Components are limited to +-max_displacement. The edge mode then applies as to
/// any other position outside.
///
/// Filters. Every filter's weights sum to 1 (to rounding), so constants are kept.
///  - Bilinear: 2 x 2 samples. Never leaves their range. Exact for linear images.
///  - Cubic: Catmull-Rom (a = -1/2), 4 x 4 samples. Exact for quadratic images.
///  - Lanczos3: 6 x 6 samples, normalised; weights within lanczos3_weight_error of sinc(x) sinc(x/3) / sum.
///  - Area: the mean of the source over the pixel's footprint, see area.h. Weights are not negative. Where the map
///    shifts or magnifies it is Bilinear.
/// Cubic and Lanczos3 have negative lobes: they ring a white pixel on black with values down to -0.075 and -0.15. A
/// headlight a hundred times as bright would get a black ring. A result therefore never falls below the smallest of its
/// four nearest samples by more than cubic_undershoot or lanczos3_undershoot, so any light rings as white does. Nothing
/// else is clamped. A picture (or alpha) within 0...1 may exceed 1 by at most cubic_overshoot or lanczos3_overshoot.
/// Bilinear and Area never leave the range of the picture. Values stay finite for finite input below 1e38 in magnitude
/// (Bilinear, Area: below 3.4e38).
///
/// Alpha must be premultiplied. Channels that are not colour are never filtered: nearest_source() serves them.
/// Bytes do not depend on the number of threads or on the processor. They do not depend on how an image is cut into
/// windows either, given the same samples around them. (`Area` also reads the displacement of a pixel's four neighbours
/// inside the map's window.)
/// Theory: PHYSICS.md#resampling.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "warp/pixels/linear_image.h"

namespace eikonal {

enum class Filter { Bilinear, Cubic /*Catmull-Rom*/, Lanczos3, Area };

/// What lies outside the input's window. Mirror: reflected with the edge pixel repeated (cba|abc|cba), as in
/// OpenImageIO. Clamp: the nearest edge pixel. Wrap: periodic. Black: zero in all channels, alpha included.
enum class Edge { Mirror, Clamp, Wrap, Black };

/// Displacement components are clamped to this magnitude [pixels].
inline constexpr float max_displacement = 1 << 30;
/// Coordinates and sizes of windows must not exceed this magnitude [pixels].
inline constexpr int max_coordinate = 1 << 28;
/// Largest error of a Lanczos3 weight, and of the sum of the six from 1.
inline constexpr double lanczos3_weight_error = 4e-7;
/// How far below its four nearest samples a result may fall, in units of reference white.
inline constexpr float cubic_undershoot = 0.075F, lanczos3_undershoot = 0.15F;
/// How far a picture within 0...1 may come out above 1: ((sum of |weights|)^2 - 1)/2 at half a pixel.
inline constexpr double cubic_overshoot = 0.282;
inline constexpr double lanczos3_overshoot = 0.70;

/// A rectangle of pixels.
using Window = PixelWindow;

/// Interleaved float pixels of a window. data: pixel (x0, y0). channels: 1..4, of which 4 is the fastest. stride:
/// floats from row to row.
struct ImageView {
    const float* data;
    Window window;
    int channels;
    std::ptrdiff_t stride;
};

/// An ImageView that can be written to.
struct MutableImageView {
    float* data;
    Window window;
    int channels;
    std::ptrdiff_t stride;
};

/// Displacement in pixels, interleaved (u, v), x right, y down. Its window is that of the output.
struct MapView {
    const float* data;
    Window window;
    std::ptrdiff_t stride;
};

struct ResampleOptions {
    Filter filter = Filter::Cubic;
    Edge edge = Edge::Mirror;
    std::array<float, 4> channel_scale{1, 1, 1, 1};  ///< dispersion: displacement of channel c is channel_scale[c]*d
};

/// out(p) = in(p + d(p)) for each p of out.window. in.window may be larger (overscan) or smaller than out.window, or
/// lie elsewhere. Positions outside in.window follow options.edge. Channels of equal scale share their fetches, so
/// equal scales are the fastest. `out` must not overlap the others. An empty out.window does nothing. Throws
/// std::invalid_argument, which means a bug of the caller: channels differ or are not 1..4, d.window is not out.window,
/// in.window is empty, a pointer is null, or coordinates are beyond max_coordinate.
void resample(const ImageView& in, const MapView& d, const MutableImageView& out, const ResampleOptions& options);

/// The source pixel nearest to (x + dx, y + dy), for channels that are not colour. Halves round to the right and down.
/// The result lies inside in_window. It is nullopt outside with Edge::Black.
std::optional<std::array<int, 2>> nearest_source(int x, int y, float dx, float dy, const Window& in_window, Edge edge);

}  // namespace eikonal
