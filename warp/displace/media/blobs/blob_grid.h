/// Fills the nodes of a displacement grid with blobs, inside their discs only (seen_blobs.h groups and interpolates
/// them).
///
/// At a depth within a blob, nodes get its closed form at that depth. Behind a blob X is a straight line in z, so the
/// first depth behind it gets the blob, and one pass over the grid carries all blobs on to the depths beyond. The cost
/// is the nodes covered times the depths within the blob. Single precision, except for differences that would lose
/// digits. The bits are the same on every processor.
#pragma once

#include <vector>

#include "warp/displace/grid/displacement_grid.h"
#include "warp/scene/camera.h"

namespace eikonal {

/// A blob as one frame's camera sees it.
struct SeenBlob {
    double right, up, forward;  ///< of its centre from the camera (orthographic: from the camera's plane) [m]
    double sigma;               ///< [m]
    double amplitude;           ///< -2 n_j strength f_px
    double reach;               ///< radius of what is not left out [m]
    int spacing;                ///< of nodes [px]
    PixelWindow disc;           ///< pixels that it reaches, cut to ±2^29
};

/// A grid of nodes `spacing` pixels apart that `cover` needs, at these depths [m], past these blobs.
DisplacementGrid filled_grid(const std::vector<const SeenBlob*>& blobs, const Camera& camera, int spacing,
                             std::vector<double> depths, const PixelWindow& cover);

}  // namespace eikonal
