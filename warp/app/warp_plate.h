/// A displacement map applied to one frame of footage, whatever it holds: every part, layer and channel of a picture,
/// or the planes of a movie frame. Colour in linear light through the resampler; data channels moved, never filtered; a
/// pixel that does not move keeps its bytes.
#pragma once

#include <variant>
#include <vector>

#include "warp/image/movie_frame.h"
#include "warp/image/picture.h"
#include "warp/resample/resample.h"

namespace eikonal {

/// One frame of footage in memory.
using Plate = std::variant<Picture, MovieFrame>;

/// Displacement on a window: interleaved (u, v) in pixels.
struct DisplacementMap {
    PixelWindow window;
    std::vector<float> uv;  ///< 2 * window.area()
};

struct WarpSettings {
    Filter filter = Filter::Cubic;
    Edge edge = Edge::Mirror;
    double dispersion = 0;
};

/// The pixels that a plate has: the union of its parts' data windows.
PixelWindow plate_window(const Plate& plate);
PixelWindow plate_display(const Plate& plate);
const Part& main_part(const Picture& picture);

/// Moves the plate. `maps` (at least one) are the instants within the shutter; their pictures are averaged, and data
/// channels follow the middle one. Every map covers plate_window(). Returns how many colour values of the plate are not
/// finite (picture.h: what they count as where something moves).
std::size_t warp_plate(Plate& plate, const std::vector<DisplacementMap>& maps, const WarpSettings& settings);

/// Main colour of a plate as linear light (movie of a sequence, picture of a movie frame).
LinearImage main_colour(const Plate& plate);

}  // namespace eikonal
