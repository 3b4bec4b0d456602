/// Parameters of every medium that a scene may hold: plain data, as the scene file states them, SI units.
/// Defaults are those of an omitted key. What a medium does with them is in the header named at each struct.
///
/// Conventions: metres, seconds, kelvin; world axes right-handed, y up. "Index" is always n - n_ambient.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace eikonal {

using glm::dvec3;

/// physical: F = n∇n (*corrected*, PHYSICS.md#ray-equation). paper: F = ½∇n (*paper*).
enum class RayEquation { Physical, Paper };
/// How the index follows from temperature: noise/medium/refractivity.h
enum class IndexModel { Air, Paper };

/// [optics]: what holds for all media and the lens.
struct OpticsSpec {
    RayEquation ray_equation = RayEquation::Physical;
    double ambient_temperature = 293.15;  ///< [K] > 0
    IndexModel index = IndexModel::Air;
    double exaggeration = 1;  ///< multiplies n - n_ambient
    double aperture = 0;      ///< diameter [m] >= 0; 0 is a point aperture
};

/// The factor on ∇n that first-order displacement takes: exaggeration, and half of it in the paper's convention.
inline double force_strength(const OpticsSpec& optics) {
    return optics.exaggeration * (optics.ray_equation == RayEquation::Paper ? 0.5 : 1.0);
}

enum class SpectrumKind { VonKarman, Paper };
enum class TurbulenceForm { Lattice, Screens, GradientNoise };

/// Strength falls as exp(-h/length) with height h = (x - origin) . normal, and is 1 for h <= 0 (PHYSICS.md#turbulence,
/// Fig. 6).
struct Falloff {
    dvec3 origin{0, 0, 0};
    dvec3 normal{0, 1, 0};  ///< normalised by the reader
    double length = 1;      ///< [m] > 0
};

/// [[medium]] type="turbulence". noise/turbulence/lattice/lattice.h, noise/turbulence/screens/screens.h,
/// noise/turbulence/gradient_noise/gradient_noise.h
struct TurbulenceSpec {
    std::uint64_t seed = 1;
    SpectrumKind spectrum = SpectrumKind::VonKarman;
    double cn2 = 1e-13;            ///< Cn² [m^-2/3] >= 0 (von Kármán)
    double outer_scale = 1.0;      ///< L0 [m] > inner_scale
    double inner_scale = 0.005;    ///< l0 [m] > 0
    double strength = 1e-12;       ///< C of S(k) = C k^(-11/3), <n'²> = ∫ S d³k (paper) >= 0
    double lowest_wavenumber = 2;  ///< k_m, cycles per lattice period (paper) >= 0
    double alpha = 0.01;           ///< [m²/s²] >= 0; 0 is frozen
    dvec3 velocity{0, 0, 0};       ///< mean motion [m/s]
    TurbulenceForm form = TurbulenceForm::Screens;
    std::optional<Falloff> falloff;
    std::optional<std::array<int, 4>> lattice;    ///< nx, ny, nz, nt; left out: chosen from camera, depth and scales
    std::optional<std::array<double, 4>> period;  ///< Lx, Ly, Lz [m], T [s]; left out: likewise
};

/// [[medium]] type="surface": T = Ta + (TS - Ta) exp(-(x - origin).normal / dropoff) (PHYSICS.md#heated-surface)
struct SurfaceSpec {
    dvec3 origin{0, 0, 0};
    dvec3 normal{0, 1, 0};
    double surface_temperature = 305;  ///< TS [K] > 0
    double dropoff = 0.01;             ///< d0 [m] > 0
};

/// One explicit hot blob.
struct BlobSpec {
    dvec3 center{0, 0, 0};
    double sigma = 0.1;         ///< [m] > 0
    double temperature = 1000;  ///< [K] > 0
};

/// Emits blobs at `from`, or along the segment from..to.
struct BlobSourceSpec {
    dvec3 from{0, 0, 0};
    std::optional<dvec3> to{};  ///< left out: a point source
    double rate = 10;           ///< blobs a second >= 0
    double temperature = 1000;  ///< at birth [K] > 0
    double sigma = 0.1;         ///< [m] > 0
    double cooling = 1;         ///< rate at which T - T_ambient decays [1/s] >= 0
    double growth = 0;          ///< diffusion: σ² grows by this every second [m²/s] >= 0
    double lifetime = 5;        ///< [s] > 0
};

/// The turbulent wind that carries blobs.
struct WindSpec {
    std::uint64_t seed = 1;
    double rms = 0.5;        ///< of each velocity component [m/s] >= 0
    double outer_scale = 1;  ///< [m] > 0
    dvec3 rise{0, 1, 0};     ///< mean velocity [m/s]
};

/// [[medium]] type="blobs" (PHYSICS.md#blobs)
struct BlobsSpec {
    std::uint64_t seed = 1;  ///< of when and where the sources give birth
    std::vector<BlobSpec> blobs;
    std::vector<BlobSourceSpec> sources;
    std::optional<WindSpec> wind;
};

enum class ProfileKind { Luneburg, FishEye, Linear, LinearSquared, Exponential, Rod, Sech };

/// [[medium]] type="profile": absolute index in closed form, used alone, for validation.
struct ProfileSpec {
    ProfileKind profile = ProfileKind::Luneburg;
    dvec3 center{0, 0, 0};
    dvec3 axis{0, 1, 0};
    double radius = 1;  ///< [m] > 0
    double n0 = 1;      ///< > 0
    double slope = 0;   ///< per metre
    double g = 1;       ///< 1/m
};

using MediumSpec = std::variant<TurbulenceSpec, SurfaceSpec, BlobsSpec, ProfileSpec>;

}  // namespace eikonal
