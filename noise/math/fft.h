/// FFTW behind one door: plans, aligned memory, and the planner's lock (the planner is not re-entrant; execution is).
///
/// Guarantee: plans are estimated, not measured, and use FFTW's portable codelets, so that the same input gives the
/// same bits on every processor and in every run. Single precision. Transforms are unnormalised:
///     inverse: x[j] = Σ_k X[k] e^{+2πi jk/N}
#pragma once

#include <fftw3.h>

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace eikonal {

using complex32 = std::complex<float>;

/// Allocator with FFTW's alignment; zero-initialises.
template <class T>
struct FftAllocator {
    using value_type = T;
    FftAllocator() = default;
    template <class U>
    FftAllocator(const FftAllocator<U>&) {}
    T* allocate(std::size_t n) {
        void* p = fftwf_malloc(n * sizeof(T));
        if (!p) throw std::bad_alloc();
        return static_cast<T*>(p);
    }
    void deallocate(T* p, std::size_t) { fftwf_free(p); }
    bool operator==(const FftAllocator&) const { return true; }
};
template <class T>
using FftVector = std::vector<T, FftAllocator<T>>;

/// The same alignment, elements left uninitialised: for buffers that are written before they are read.
template <class T>
struct FftScratchAllocator : FftAllocator<T> {
    FftScratchAllocator() = default;
    template <class U>
    FftScratchAllocator(const FftScratchAllocator<U>&) {}
    template <class U>
    void construct(U*) {}
};
template <class T>
using FftScratch = std::vector<T, FftScratchAllocator<T>>;

/// Plan of a multi-dimensional complex-to-real inverse transform, or complex to complex. Row-major, last dimension
/// fastest and, for complex-to-real, halved: n_last/2 + 1. Executing is thread-safe on distinct arrays from FftVector.
class FftPlan {
  public:
    enum class Kind { ComplexToReal, ComplexToComplex };

    /// dims: sizes, slowest first, each >= 1. `howmany` transforms stored one after the other.
    FftPlan(Kind kind, std::span<const int> dims, int howmany = 1);

    /// Inverse, complex to real; the input is overwritten.
    void execute(complex32* in, float* out) const;
    /// Inverse, complex to complex, not in place.
    void execute(complex32* in, complex32* out) const;

    /// Number of complex values of one half-complex (or complex) spectrum and of real (or complex) samples.
    std::size_t spectrum_size() const { return spectrum_size_; }
    std::size_t sample_size() const { return sample_size_; }

  private:
    struct Destroy {
        void operator()(fftwf_plan_s* plan) const;
    };
    std::unique_ptr<fftwf_plan_s, Destroy> plan_;
    std::size_t spectrum_size_ = 0, sample_size_ = 0;
};

/// Smallest size >= n with only factors 2, 3, 5.
int good_fft_size(int n);

}  // namespace eikonal
