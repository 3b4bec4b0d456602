#include "warp/displace/grid/lagrange.h"

namespace eikonal {

LagrangeWeights lagrange_weights(double f) {
    LagrangeWeights w{};
    for (int i = 0; i < kLagrangeNodes; ++i) {
        double v = 1;
        for (int j = 0; j < kLagrangeNodes; ++j)
            if (j != i) v *= (f - (j - kNodesBefore)) / (i - j);
        w[static_cast<std::size_t>(i)] = static_cast<float>(v);
    }
    return w;
}

std::vector<LagrangeWeights> lagrange_phases(int spacing) {
    std::vector<LagrangeWeights> phases;
    for (int p = 0; p < spacing; ++p) phases.push_back(lagrange_weights(static_cast<double>(p) / spacing));
    return phases;
}

const LagrangeWeights& tabulated_lagrange_weights(double f) {
    constexpr int kIntervals = 256;
    static const std::vector<LagrangeWeights> table = [] {
        std::vector<LagrangeWeights> weights = lagrange_phases(kIntervals);
        weights.push_back(lagrange_weights(1));
        return weights;
    }();
    return table[static_cast<std::size_t>(f * kIntervals + 0.5)];
}

}  // namespace eikonal
