/// A displacement map applied to one frame of footage, whatever it holds: every part, layer and channel of a picture,
/// or the planes of a movie frame. Colour in linear light through the resampler; data channels moved, never filtered; a
/// pixel that does not move keeps its bytes.
#pragma once

#include <stop_token>
#include <variant>
#include <vector>

#include "warp/image/movie_frame.h"
#include "warp/image/picture.h"
#include "warp/resample/resample.h"
#include "warp/shimmer/displacement_map.h"

namespace eikonal {

/// One frame of footage in memory.
using Plate = std::variant<Picture, MovieFrame>;

struct WarpSettings {
    Filter filter = Filter::Cubic;
    Edge edge = Edge::Mirror;
    double dispersion = 0;      ///< 0: off; 1: that of true air
    std::stop_token stop = {};  ///< once requested, work ends with a FrameError
};

/// The pixels that a plate has: the union of its parts' data windows.
PixelWindow plate_window(const Plate& plate);
PixelWindow plate_display(const Plate& plate);
const Part& main_part(const Picture& picture);

/// Moves the plate. `maps` (at least one) are the instants within the shutter; their pictures are averaged, and data
/// channels follow the middle one. Every map covers plate_window(). Returns how many colour values of the plate are not
/// finite (picture.h: what they count as where something moves).
std::size_t warp_plate(Plate& plate, const std::vector<DisplacementMap>& maps, const WarpSettings& settings);

/// Four lanes of linear light (linear_image.h), moved alike: the mean of the pictures that the maps make, which cover
/// in.data. colour: lanes 0, 1, 2 are red, green and blue, which dispersion tells apart.
void warp_lanes(const LinearImage& in, const std::vector<DisplacementMap>& maps, const WarpSettings& settings,
                bool colour, LinearImage& out);

/// One flag a pixel of `window`, row by row: whether any of the maps moves it.
std::vector<std::uint8_t> moved_pixels(const std::vector<DisplacementMap>& maps, const PixelWindow& window);

/// Main colour of a plate as linear light (movie of a sequence, picture of a movie frame).
LinearImage main_colour(const Plate& plate);

}  // namespace eikonal
