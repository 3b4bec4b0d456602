#include <algorithm>

#include "noise/blobs/blobs.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/medium/keys.h"

namespace eikonal {

/// What a key may hold, as a scene file may state it.
static Range within(const BlobKeyRange& allowed) {
    return between(allowed.least, std::min(allowed.most, kLargestValue));
}

static Keys keys(BlobSpec& b) {
    return {
        {"center", "", "m", b.center},
        {"sigma", "radius", "m", b.sigma, {within(kBlobSigma)}},
        {"temperature", "", "K", b.temperature, {within(kBlobTemperature)}},
    };
}

static Keys keys(BlobSourceSpec& s) {
    return {
        {"from", "the source, or one end of it", "m", s.from},
        {"to", "its other end, of a line", "m", s.to},
        {"rate", "blobs a second", s.rate, {within(kBlobRate)}},
        {"temperature", "at birth", "K", s.temperature, {within(kBlobTemperature)}},
        {"sigma", "radius", "m", s.sigma, {within(kBlobSigma)}},
        {"cooling", "", "1/s", s.cooling, {at_least(0)}},
        {"growth", "of sigma squared, by diffusion", "m²/s", s.growth, {at_least(0)}},
        Key("lifetime", "of each blob", "s", s.lifetime, {within(kBlobLifetime)}).required(),
    };
}

static Keys keys(WindSpec& w) {
    return {
        {"seed", "of its random numbers", w.seed},
        {"rms", "of each component of the velocity", "m/s", w.rms, {within(kWindSpeed)}},
        {"outer_scale", "largest eddies", "m", w.outer_scale, {within(kWindOuterScale)}},
        {"rise", "mean velocity", "m/s", w.rise, {within(kWindRise)}},
    };
}

Keys keys(BlobsSpec& b) {
    return {
        {"seed", "of its random numbers", b.seed},
        {"blob", "explicit blobs", b.blobs},
        {"source", "sources of blobs", b.sources},
        {"wind", "that carries the blobs", b.wind},
    };
}

}  // namespace eikonal
