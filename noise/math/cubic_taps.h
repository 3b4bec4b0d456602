/// The cubic B-spline's four taps in double precision, with their derivatives: what jets of the periodic splines are
/// made of (lattice_snapshot.h, periodic_spline.h).
#pragma once

#include <cstring>

namespace eikonal {

/// Functions that take or give it by value are always inlined: its calling convention differs between the versions of
/// EIKONAL_CLONES (noise/base/instruction_sets.h).
using Double4 = double __attribute__((vector_size(32)));

/// Weights of the coefficients at -1, 0, 1, 2 at offset t in [0, 1], and their first and second derivatives. The second
/// are linear: a spline's Hessian is continuous and piecewise linear along each axis.
struct CubicTaps {
    Double4 weight, slope, curvature;

    explicit CubicTaps(double t) {
        const double s = 1 - t;
        weight = Double4{s * s * s, 4 + t * t * (3 * t - 6), 4 + s * s * (3 * s - 6), t * t * t} / 6;
        slope = Double4{-s * s, t * (3 * t - 4), -s * (3 * s - 4), t * t} / 2;
        curvature = Double4{s, 3 * t - 2, 3 * s - 2, t};
    }
};

/// Four stored coefficients.
[[gnu::always_inline]] inline Double4 load_taps(const float* p) {
    float __attribute__((vector_size(16))) v;
    std::memcpy(&v, p, sizeof v);
    return __builtin_convertvector(v, Double4);
}

[[gnu::always_inline]] inline double dot4(Double4 a, Double4 b) {
    const Double4 p = a * b;
    return (p[0] + p[2]) + (p[1] + p[3]);
}

}  // namespace eikonal
