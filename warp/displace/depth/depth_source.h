/// Where each pixel's object is, as whoever asks for a displacement map says.
#pragma once

#include <variant>

namespace eikonal {

class DepthPlane;

/// One axial depth for all pixels [m], or a depth buffer, which must outlive this.
using DepthSource = std::variant<double, const DepthPlane*>;

}  // namespace eikonal
