/// Slices of a medium's index and force, as `eikonal field` writes them.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace eikonal {

using glm::dvec3;

/// Samples along each axis of a medium that has no lattice of its own.
inline constexpr int kFieldSamples = 64;
/// Values a sample: n - n_ambient, then F along x, y and z [1/m].
inline constexpr int kFieldChannels = 4;

/// An upright box between two corners [m].
struct Box {
    dvec3 low{0, 0, 0}, high{0, 0, 0};
};

struct FieldSlices {
    int count = 0;              ///< slices along z
    int width = 0, height = 0;  ///< samples along x and y; row 0 has the greatest y
    /// Writes one slice: kFieldChannels values a sample, row by row. Slices may be asked for in any order.
    std::function<void(int slice, std::span<float> values)> fill;
    std::function<double(int slice)> position;               ///< z of a slice [m]
    std::vector<std::pair<std::string, double>> attributes;  ///< spacing, period, time: for the file's header

    /// Adds the attributes eikonal/period.{x,y,z,t} [m, s], 0 where there is none, eikonal/spacing.{x,y,z} [m] and
    /// eikonal/time [s].
    void describe(const double (&period)[4], const dvec3& spacing, double t);
};

}  // namespace eikonal
