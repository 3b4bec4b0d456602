/// The depth of each pixel's object, as the caller of a displacement map states it.
#pragma once

#include <variant>

namespace eikonal {

class DepthPlane;

/// One axial depth for all pixels [m], or a depth buffer, which must outlive this.
using DepthSource = std::variant<double, const DepthPlane*>;

}  // namespace eikonal
