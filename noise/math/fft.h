/// Fast Fourier transforms by FFTW: plans, aligned memory, and the lock of the planner.
///
/// The same input gives the same bits on every processor and in every run. Plans are therefore estimated, not measured,
/// and use FFTW's scalar codelets. FFTW's planner is not re-entrant, so all use of it is locked. Execution is
/// thread-safe. Precision is single. Transforms are inverse and unnormalised:
///     x[j] = Σ_k X[k] e^{+2πi jk/N}
/// Failures: std::bad_alloc, and std::runtime_error where FFTW has no plan.
/// Theory: PHYSICS.md#lattice.
#pragma once

#include <fftw3.h>

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace eikonal {

using complex32 = std::complex<float>;

/// Allocator with the alignment that FFTW wants. Elements are initialised to zero.
template <class T>
struct FftAllocator {
    using value_type = T;
    FftAllocator() = default;
    template <class U>
    FftAllocator(const FftAllocator<U>&) {}  // NOLINT(google-explicit-constructor): allocators convert
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

/// The same alignment, but elements stay uninitialised. For buffers that are written before they are read.
template <class T>
struct FftScratchAllocator : FftAllocator<T> {
    FftScratchAllocator() = default;
    template <class U>
    FftScratchAllocator(const FftScratchAllocator<U>&) {}  // NOLINT(google-explicit-constructor): likewise
    template <class U>
    void construct(U*) {}
};
template <class T>
using FftScratch = std::vector<T, FftScratchAllocator<T>>;

/// Plan of an inverse transform in several dimensions, complex to real or complex to complex. Arrays are row-major: the
/// last dimension is the fastest. A spectrum for complex-to-real holds only n_last/2 + 1 bins along it. Executing is
/// thread-safe on distinct arrays, which must be FftVector or FftScratch.
class FftPlan {
  public:
    enum class Kind { ComplexToReal, ComplexToComplex };

    /// dims: sizes, slowest first, each >= 1. howmany: transforms, stored one after the other.
    FftPlan(Kind kind, std::span<const int> dims, int howmany = 1);

    /// Complex to real. The input is overwritten.
    void execute(complex32* in, float* out) const;
    /// Complex to complex. The two arrays must differ.
    void execute(complex32* in, complex32* out) const;

    /// Number of values in one spectrum, and number of samples.
    std::size_t spectrum_size() const { return spectrum_size_; }
    std::size_t sample_size() const { return sample_size_; }

  private:
    struct Destroy {
        void operator()(fftwf_plan_s* plan) const;
    };
    std::unique_ptr<fftwf_plan_s, Destroy> plan_;
    std::size_t spectrum_size_ = 0, sample_size_ = 0;
};

/// The smallest size >= n whose only prime factors are 2, 3 and 5.
int good_fft_size(int n);

}  // namespace eikonal
