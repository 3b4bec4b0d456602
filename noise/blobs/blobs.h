/// The hot blobs of one medium at any time (PHYSICS.md#blobs): n - n_ambient = Σ_j n_j exp(-|x - x_j|²/σ_j²).
///
/// Explicit blobs are a picture that the artist has placed: they exist at all times, stand still and keep their
/// temperature; the wind does not carry them. Sources have always burnt, so that t = 0 is a time like any other.
///
/// Births. A source bears one blob in each interval 1/rate, at a random time within it and at a random place on its
/// segment, both hashed from the number i of the interval: t_i = (i + u_i)/rate, any sign of i. Those with
/// t - lifetime < t_i <= t are alive.
/// Life, at age τ = t - t_i (*paper*: cooling, carrying; *added*: growth and the ends):
///     σ² = σ0² + growth τ
///     T - T_a = (T0 - T_a) e^{-cooling τ} (σ0/σ)³        diffusion keeps the heat while it spreads it
///     n_j = n(T) - n(T_a) (noise/medium/refractivity.h), times a smooth rise over the first kBirthPart of the lifetime
///     and a smooth fall over the last kFadePart of it, so that nothing pops in a shot; 0 once it is as cool as the air
///     dx/dt = v(x, t) (noise/blobs/wind.h); without a wind a blob stays where it was born
///
/// Random access: any t at the same cost, from the specification alone. Carried blobs follow the wind's absolute time
/// grid from birth on; where they are at a grid time is kept for frames to come (at most kCarriedBytes), and is the
/// same bits as when found anew. The paper's 300 blobs of 5 s in a wind of 0.5 m/s and 1 m: one core needs 10 ms for
/// the first frame, two thirds of it for the wind's 31 instants, and 0.4 ms a frame at 25 frames a second from then on.
///
/// Range: |t| <= kLatestTime where there are sources, else any t. Every key's range is below; within it all results are
/// finite. Same bits for any number of threads, order of calls and processor. Thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "noise/blobs/blob_kernel.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/blobs/wind.h"
#include "noise/math/random.h"
#include "noise/medium/refractivity.h"

namespace eikonal {

/// Explicit and living blobs of a medium together.
inline constexpr double kMostBlobs = 1e6;
inline constexpr double kBirthPart = 0.05, kFadePart = 0.1;
inline constexpr double kLatestTime = 1e9;  ///< [s]
inline constexpr double kCarriedBytes = 64e6;
inline constexpr double kFastestEddy = 6;

/// What a key of the specification may hold.
struct BlobKeyRange {
    double least, most;
    const char* unit;
};
inline constexpr BlobKeyRange kBlobPlace{-1e12, 1e12, "m"}, kBlobSigma{1e-6, 1e9, "m"},
    kBlobTemperature{kLeastTemperature, kGreatestTemperature, "K"}, kBlobRate{0, 1e9, "1/s"},
    kBlobCooling{0, 1e300, "1/s"}, kBlobGrowth{0, 1e12, "m²/s"}, kBlobLifetime{1e-6, 1e9, "s"},
    kWindSpeed{0, 1e6, "m/s"}, kWindRise{-1e6, 1e6, "m/s"}, kWindOuterScale{1e-6, 1e9, "m"};

/// Where blobs can be, and what they can be, at any time: for those who ask whether a medium matters to a view.
struct BlobHome {
    Blob largest;   ///< the center of the home; the widest sigma and the largest |n| that occur, without exaggeration
    double radius;  ///< every blob's centre is within [m]
    double most;    ///< blobs at a time
};

class BlobCloud {
  public:
    /// name: of the medium, for messages, e.g. "medium.0". UserError, naming the key: a value that is not finite or out
    /// of range, more than kMostBlobs alive (before anything is allocated), those of the scene's earlier media, of
    /// which there are so many, among them.
    BlobCloud(const BlobsSpec& spec, const IndexLaw& law, std::string_view name, double earlier = 0);

    /// Explicit blobs, then the living ones of each source in order of birth; n without exaggeration. Blobs that have
    /// no index left (n = 0) are listed. FrameError beyond kLatestTime.
    std::vector<Blob> at(double t) const;

    /// Largest number of blobs that `at` can return.
    double most() const { return most_; }
    /// Of each explicit blob, then of each source that emits any. The wind's eddies are taken to carry no blob faster
    /// than kFastestEddy rms for all its life.
    std::vector<BlobHome> homes() const;

  private:
    /// Numbers of a source's blobs: first … last, none if last < first.
    struct Range {
        std::int64_t first, last;
        std::size_t size() const { return last < first ? 0 : static_cast<std::size_t>(last - first + 1); }
    };
    struct Source {
        BlobSourceSpec spec;
        RandomStream stream;

        double birth_time(std::int64_t i) const;
        dvec3 birth_place(std::int64_t i) const;
        /// Born after `after` and no later than `until`.
        Range born(double after, double until) const;
    };
    /// Blobs of every source at a grid time of the wind: those born in earlier intervals, and old ones up to some that
    /// have just died.
    struct Carried {
        std::vector<Range> range;               ///< of each source
        std::vector<std::vector<dvec3>> place;  ///< the same
    };

    Blob living(const Source& source, double age, const dvec3& center) const;
    Range carried_range(const Source& source, std::int64_t k) const;
    /// Carries places of a source's blobs through the interval from grid time k; those not yet born are left alone.
    void advance(const Source& source, const WindInterval& interval, double k, const Range& range,
                 std::vector<dvec3>& place) const;
    std::shared_ptr<const Carried> carried(std::int64_t k) const;
    /// Of every living blob, source by source.
    std::vector<std::vector<dvec3>> places(double t, const std::vector<Range>& range) const;

    std::string name_;
    IndexLaw law_;
    std::vector<Blob> explicit_;
    std::vector<Source> sources_;
    double most_ = 0;
    dvec3 rise_{0, 0, 0};
    std::unique_ptr<const Wind> wind_;  ///< null: nothing but rise
    std::unique_ptr<const BoundedCache<Carried>> recent_;
};

}  // namespace eikonal
