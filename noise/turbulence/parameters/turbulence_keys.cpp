#include <fmt/format.h>

#include <string>

#include "noise/medium/keys.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

/// Sizes for which FFTW has a fast transform are 2 … kLargestLattice without a prime factor above kLargestFactor.
static constexpr int kLargestFactor = 13;
static constexpr int kLargestLattice = 65536;

static EnumNames<SpectrumKind> names(SpectrumKind) {
    static constexpr std::pair<std::string_view, SpectrumKind> list[] = {{"von-karman", SpectrumKind::VonKarman},
                                                                         {"paper", SpectrumKind::Paper}};
    return list;
}

static EnumNames<TurbulenceForm> names(TurbulenceForm) {
    static constexpr std::pair<std::string_view, TurbulenceForm> list[] = {
        {"lattice", TurbulenceForm::Lattice},
        {"screens", TurbulenceForm::Screens},
        {"gradient-noise", TurbulenceForm::GradientNoise}};
    return list;
}

/// What is wrong with a lattice size, empty if nothing is.
static std::string lattice_size_error(int n) {
    const auto good = [](int size) {
        for (int factor = 2; factor <= kLargestFactor; ++factor)
            while (size % factor == 0) size /= factor;
        return size == 1;
    };
    if (n < 2) return fmt::format("size {} is no lattice; must be >= 2", n);
    if (good(n)) return {};
    int below = n, above = n;
    while (!good(below)) --below;
    while (!good(above)) ++above;  // ends at a power of two
    return fmt::format("size {} has a prime factor above {}, for which there is no fast transform; use {} or {}", n,
                       kLargestFactor, below, above);
}

static Keys keys(Falloff& f) {
    return {
        {"origin", "where strength is 1", "m", f.origin},
        direction_key("normal", "away from the heat", f.normal),
        {"length", "over which strength falls by e", "m", f.length, {positive()}},
    };
}

Keys keys(TurbulenceSpec& t) {
    const auto lattice_error = [&t]() -> std::string {
        for (std::size_t axis = 0; axis < t.lattice->size(); ++axis) {
            const int n = (*t.lattice)[axis];
            if (t.form == TurbulenceForm::Screens && axis == 2 && n >= 1)
                continue;  // screens are not transformed over z
            if (const std::string wrong = lattice_size_error(n); !wrong.empty()) return wrong;
        }
        return {};
    };
    return {
        {"seed", "of its random numbers", t.seed},
        {"spectrum", "spatial spectrum of the index", t.spectrum},
        Key("cn2", "Cn²", "m^-2/3", t.cn2, {at_least(0)}).only_with("spectrum", t.spectrum, {SpectrumKind::VonKarman}),
        Key("outer_scale", "L0, the largest eddies", "m", t.outer_scale, {positive()}).always([&t] {
            const bool ordered = t.outer_scale > t.inner_scale;
            return ordered ? "" : fmt::format("value {}, must be > inner_scale, {}", t.outer_scale, t.inner_scale);
        }),
        {"inner_scale", "l0, the smallest eddies", "m", t.inner_scale, {positive()}},
        Key("strength", "C of S(k) = C k^(-11/3)", t.strength, {at_least(0)})
            .only_with("spectrum", t.spectrum, {SpectrumKind::Paper}),
        Key("lowest_wavenumber", "k_m, cycles per lattice period", t.lowest_wavenumber, {at_least(0)})
            .only_with("spectrum", t.spectrum, {SpectrumKind::Paper}),
        {"alpha", "how fast eddies change", "m²/s²", t.alpha, {at_least(0)}},
        {"velocity", "mean motion", "m/s", t.velocity},
        {"form", "how the turbulence is made", t.form},
        {"falloff", "strength with height above the heat", t.falloff},
        Key("lattice", "sizes nx, ny, nz, nt", t.lattice, {between(0, kLargestLattice)}).given(lattice_error),
        {"period", Quantities{{"Lx", "m"}, {"Ly", "m"}, {"Lz", "m"}, {"T", "s"}}, t.period, {positive()}},
    };
}

}  // namespace eikonal
