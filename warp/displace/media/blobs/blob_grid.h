/// Fills the nodes of a displacement grid with blobs, inside their discs only (seen_blobs.h groups and interpolates
/// them).
///
/// At a depth within a blob, nodes get its closed form at that depth. Behind a blob X is a straight line in z. The blob
/// is therefore added to the first depth behind it, and one pass over the grid carries all blobs on to the depths
/// beyond. The cost is the number of nodes covered times the number of depths within the blob. Computed in single
/// precision, except for differences that would lose digits. The bits are the same on every processor.
#pragma once

#include <vector>

#include "warp/displace/grid/displacement_grid.h"
#include "warp/scene/camera.h"

namespace eikonal {

/// A blob as the camera of one frame sees it.
struct SeenBlob {
    double right, up, forward;  ///< its centre relative to the camera (orthographic: to the camera's plane) [m]
    double sigma;               ///< [m]
    double amplitude;           ///< -2 n_j strength f_px
    double reach;               ///< radius beyond which it is left out [m]
    int spacing;                ///< spacing of nodes [px]
    PixelWindow disc;           ///< pixels within its reach, clamped to ±2^29
};

/// A grid of these blobs at these depths [m]. It has the nodes, `spacing` pixels apart, that the pixels of `cover`
/// need.
DisplacementGrid filled_grid(const std::vector<const SeenBlob*>& blobs, const Camera& camera, int spacing,
                             std::vector<double> depths, const PixelWindow& cover);

}  // namespace eikonal
