#include "noise/math/fft.h"

#include <algorithm>
#include <mutex>
#include <stdexcept>

namespace eikonal {
namespace {

std::mutex& planner_lock() {
    static std::mutex lock;
    return lock;
}

// FFTW chooses SIMD codelets by processor, and they round differently. Hence scalar codelets only.
constexpr unsigned kPlanFlags = FFTW_ESTIMATE | FFTW_NO_SIMD;

}  // namespace

void FftPlan::Destroy::operator()(fftwf_plan_s* plan) const {
    const std::lock_guard lock(planner_lock());
    fftwf_destroy_plan(plan);
}

FftPlan::FftPlan(Kind kind, std::span<const int> dims, int howmany) {
    std::size_t samples = 1;
    for (const int n : dims) samples *= static_cast<std::size_t>(n);
    const bool real = kind == Kind::ComplexToReal;
    sample_size_ = samples;
    spectrum_size_ =
        real ? samples / static_cast<std::size_t>(dims.back()) * static_cast<std::size_t>(dims.back() / 2 + 1)
             : samples;
    // Estimation touches neither array, but FFTW reads their alignment.
    FftVector<complex32> in(1);
    FftVector<complex32> out(1);
    auto* pi = reinterpret_cast<fftwf_complex*>(in.data());
    auto* po = reinterpret_cast<fftwf_complex*>(out.data());
    const int rank = static_cast<int>(dims.size());
    const int idist = static_cast<int>(spectrum_size_), odist = static_cast<int>(sample_size_);
    const std::lock_guard lock(planner_lock());
    plan_.reset(real ? fftwf_plan_many_dft_c2r(rank, dims.data(), howmany, pi, nullptr, 1, idist,
                                               reinterpret_cast<float*>(po), nullptr, 1, odist,
                                               kPlanFlags | FFTW_DESTROY_INPUT)
                     : fftwf_plan_many_dft(rank, dims.data(), howmany, pi, nullptr, 1, idist, po, nullptr, 1, odist,
                                           FFTW_BACKWARD, kPlanFlags));
    if (!plan_) throw std::runtime_error("FFTW has no plan for this size");
}

void FftPlan::execute(complex32* in, float* out) const {
    fftwf_execute_dft_c2r(plan_.get(), reinterpret_cast<fftwf_complex*>(in), out);
}

void FftPlan::execute(complex32* in, complex32* out) const {
    fftwf_execute_dft(plan_.get(), reinterpret_cast<fftwf_complex*>(in), reinterpret_cast<fftwf_complex*>(out));
}

int good_fft_size(int n) {
    for (int m = std::max(n, 1);; ++m) {
        int r = m;
        for (const int p : {2, 3, 5})
            while (r % p == 0) r /= p;
        if (r == 1) return m;
    }
}

}  // namespace eikonal
