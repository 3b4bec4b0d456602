/// Slices of a medium's index and force, in the form that `eikonal field` writes.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace eikonal {

using glm::dvec3;

/// Number of samples along each axis, for a medium without a lattice of its own.
inline constexpr int kFieldSamples = 64;
/// Number of values of a sample: n - n_ambient, then F along x, y and z [1/m].
inline constexpr int kFieldChannels = 4;

/// A box between two corners [m], with sides along the axes.
struct Box {
    dvec3 low{0, 0, 0}, high{0, 0, 0};
};

struct FieldSlices {
    int count = 0;              ///< number of slices along z
    int width = 0, height = 0;  ///< samples along x and y; row 0 has the greatest y
    /// Computes one slice into `values`: kFieldChannels values a sample, row by row. Slices may be computed in any
    /// order.
    std::function<void(int slice, std::span<float> values)> fill;
    std::function<double(int slice)> position;               ///< z of a slice [m]
    std::vector<std::pair<std::string, double>> attributes;  ///< spacing, period and time, for the file's header

    /// Adds the attributes eikonal/period.{x,y,z,t} [m, s], 0 if there is no period, eikonal/spacing.{x,y,z} [m] and
    /// eikonal/time [s].
    void describe(const double (&period)[4], const dvec3& spacing, double t);
};

}  // namespace eikonal
