/// Applies a displacement map to one frame of footage: to every part, layer and channel of a picture, or to the planes
/// of a movie frame. Colour is resampled in linear light. Data channels are moved without any filter. A pixel that does
/// not move keeps its bytes.
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
    double dispersion = 0;      ///< 0: off; 1: as strong as in real air
    std::stop_token stop = {};  ///< once requested, work ends with a FrameError
};

/// The pixels that a plate has: the union of its parts' data windows.
PixelWindow plate_window(const Plate& plate);
PixelWindow plate_display(const Plate& plate);
const Part& main_part(const Picture& picture);

/// Displaces the plate. `maps` (at least one) belong to the instants within the shutter. The pictures of all instants
/// are averaged; data channels follow the middle one. Every map must cover plate_window(). Returns the number of colour
/// values of the plate that are not finite (picture.h states how they count where something moves).
std::size_t warp_plate(Plate& plate, const std::vector<DisplacementMap>& maps, const WarpSettings& settings);

/// Displaces four lanes of linear light (linear_image.h) alike. The result is the mean of the pictures of all maps,
/// which must cover in.data. colour: whether lanes 0, 1, 2 are red, green and blue, between which dispersion
/// distinguishes.
void warp_lanes(const LinearImage& in, const std::vector<DisplacementMap>& maps, const WarpSettings& settings,
                bool colour, LinearImage& out);

/// One flag a pixel of `window`, row by row: whether any of the maps moves the pixel.
std::vector<std::uint8_t> moved_pixels(const std::vector<DisplacementMap>& maps, const PixelWindow& window);

/// The main colour of a plate in linear light. It is needed to make a movie from a sequence or a picture from a movie.
LinearImage main_colour(const Plate& plate);

}  // namespace eikonal
