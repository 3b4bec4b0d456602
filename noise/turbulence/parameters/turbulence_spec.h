/// [[medium]] type = "turbulence": its parameters as the scene file states them, in SI units. Each default is that of
/// an omitted key. World axes are right-handed with y up.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "noise/medium/medium_hooks.h"

namespace eikonal {

using glm::dvec3;

enum class SpectrumKind { VonKarman, Paper };
/// How turbulence is made: a periodic lattice, thin screens, or octaves of gradient noise.
enum class TurbulenceForm { Lattice, Screens, GradientNoise };

/// Strength falls as exp(-h/length) with height h = (x - origin)·normal, and is 1 for h <= 0. PHYSICS.md#turbulence
struct Falloff {
    dvec3 origin{0, 0, 0};
    dvec3 normal{0, 1, 0};  ///< normalised by the reader
    double length = 1;      ///< [m] > 0
};

struct TurbulenceSpec {
    static constexpr std::string_view kType = "turbulence";

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

    /// Cn² or C, whichever the spectrum takes.
    double source() const { return spectrum == SpectrumKind::VonKarman ? cn2 : strength; }
};

// Hooks of the medium interface (noise/medium/medium_spec.h).
Keys keys(TurbulenceSpec& spec);
std::string why_still(const TurbulenceSpec& spec, const OpticsSpec& optics);
std::unique_ptr<const Medium> build_medium(const TurbulenceSpec& spec, const MediumSetting& setting);
void mix_seeds(TurbulenceSpec& spec, const RandomStream& stream);

}  // namespace eikonal
