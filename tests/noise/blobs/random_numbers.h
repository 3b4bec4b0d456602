/// Random numbers over decades, for tests.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "noise/blobs/blob_kernel.h"

namespace eikonal {

using Random = std::mt19937_64;
inline double uniform(Random& random, double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
}
inline double decades(Random& random, double lo, double hi) {
    return std::pow(10, uniform(random, lo, hi));
}
inline double sign(Random& random) {
    return (random() & 1) != 0 ? 1 : -1;
}

}  // namespace eikonal
