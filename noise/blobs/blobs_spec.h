/// [[medium]] type = "blobs": hot blobs, their sources and the wind that carries them, as the scene file states them,
/// in SI units. Each default is that of an omitted key. PHYSICS.md#blobs
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "noise/medium/medium_hooks.h"

namespace eikonal {

using glm::dvec3;

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

struct BlobsSpec {
    static constexpr std::string_view kType = "blobs";

    std::uint64_t seed = 1;  ///< of when and where the sources give birth
    std::vector<BlobSpec> blobs;
    std::vector<BlobSourceSpec> sources;
    std::optional<WindSpec> wind;
};

// Hooks of the medium interface (noise/medium/medium_spec.h).
Keys keys(BlobsSpec& spec);
std::string why_still(const BlobsSpec& spec, const OpticsSpec& optics);
std::unique_ptr<const Medium> build_medium(const BlobsSpec& spec, const MediumSetting& setting);
void mix_seeds(BlobsSpec& spec, const RandomStream& stream);

}  // namespace eikonal
