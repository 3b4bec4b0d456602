/// Blobs filled into the nodes of a grid (grid.h), inside their discs only: what blob_bends.h groups and interpolates.
///
/// A layer of depth within a blob gets its closed form at that depth. From the first layer behind it on the blob's X is
/// straight in z: that layer alone gets it, and one pass over the grid takes all of it on to the layers beyond. Cost is
/// nodes covered × layers within the blob. Single precision, but for what cancels; same bits on every processor.
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
