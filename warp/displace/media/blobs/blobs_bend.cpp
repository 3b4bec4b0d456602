#include "warp/displace/media/blobs/blobs_bend.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "noise/blobs/blobs_spec.h"
#include "noise/math/random.h"
#include "warp/displace/media/blobs/seen_blobs.h"
#include "warp/displace/media/sampled_variance.h"
#include "warp/displace/models/second_order.h"

namespace eikonal {
namespace {

/// The expected rms is taken over instants that show about kRmsBlobs blobs in all, and over at least kFewestRmsPixels
/// pixels of each. If a wind carries the blobs, at most kMostRmsWinds instants with blobs are used, because a wind is
/// expensive.
constexpr double kRmsBlobs = 600;
constexpr int kFewestRmsInstants = 2, kMostRmsInstants = 512, kMostRmsWinds = 16, kFewestRmsPixels = 16;

int rms_instants(const BlobsSpec& spec, const BlobCloud& cloud) {
    if (spec.sources.empty()) return 1;
    return static_cast<int>(
        std::clamp<double>(std::ceil(kRmsBlobs / cloud.most()), kFewestRmsInstants, kMostRmsInstants));
}

/// A cloud of more blobs than kManyBlobs always has some of them in it. A rough rms then needs only kRoughRays pixels.
constexpr double kManyBlobs = 64;
constexpr int kRoughRays = 64;
/// A blob moves pixels up to about kRmsReach from its middle [σ]. More than kDenseBlobs blobs move almost every pixel.
constexpr double kRmsReach = 3;
constexpr std::size_t kDenseBlobs = 4096;
/// Number of pairs of pixels among blobs that the focusing is estimated from.
constexpr std::size_t kBlobPairs = 96;

/// Draws pixels that blobs may move: half of them from the whole picture, half from the surroundings of a blob in the
/// picture.
class BlobPixels {
  public:
    BlobPixels(const std::vector<SeenBlob>& blobs, const Camera& camera, const PixelWindow& picture)
        : picture_(picture) {
        if (blobs.size() > kDenseBlobs) return;
        for (const SeenBlob& blob : blobs) {
            const bool perspective = camera.projection == Projection::Perspective;
            const double scale = perspective ? 1 / std::max(blob.forward, blob.sigma) : 1;
            const dvec2 middle = camera.pixel(scale * dvec2(blob.right, blob.up));
            const double reach = kRmsReach * blob.sigma * scale * camera.f_px;
            const auto low = [](double edge) { return static_cast<int>(std::clamp(std::floor(edge), 0.0, 1e9)); };
            const auto high = [](double edge, int size) {
                return static_cast<int>(std::clamp<double>(std::ceil(edge), 0, size));
            };
            const int x0 = low(middle.x - reach), x1 = high(middle.x + reach, picture.width);
            const int y0 = low(middle.y - reach * camera.pixel_aspect),
                      y1 = high(middle.y + reach * camera.pixel_aspect, picture.height);
            if (x1 > x0 && y1 > y0) around_.push_back({x0, y0, x1 - x0, y1 - y0});
        }
    }
    /// A drawn pixel. Its weight is the density of an even draw from the picture, divided by that of this draw.
    struct Drawn {
        int x, y;
        double weight;
    };
    Drawn draw(const RandomStream& stream, int i) const {
        if (around_.empty()) {
            const auto [x, y] = spread_pixel(i, picture_.width, picture_.height);
            return {x, y, 1};
        }
        auto [x, y] = spread_pixel(i / 2, picture_.width, picture_.height);
        if (i % 2 == 1) {
            const auto at = [&](std::uint64_t c, double size) {
                return static_cast<int>(stream.uniform(4 * static_cast<std::uint64_t>(i) + c) * size);
            };
            const PixelWindow& w = around_[static_cast<std::size_t>(at(1, static_cast<double>(around_.size())))];
            x = w.x0 + at(2, w.width);
            y = w.y0 + at(3, w.height);
        }
        double times = 0;
        for (const PixelWindow& w : around_)
            if (x >= w.x0 && y >= w.y0 && x < w.x0 + w.width && y < w.y0 + w.height)
                times += static_cast<double>(picture_.area()) / static_cast<double>(w.area());
        return {x, y, 1 / (0.5 + 0.5 * times / static_cast<double>(around_.size()))};
    }

  private:
    PixelWindow picture_;
    std::vector<PixelWindow> around_;
};

/// Blobs at one frame. Grids are made tile by tile from the blobs that each tile sees.
class Instant final : public BendInstant {
  public:
    Instant(SeenBlobs seen, const FrameView& frame)
        : seen_(std::move(seen)), nearest_(frame.nearest), farthest_(frame.farthest), gain_(frame.gain) {}

    std::vector<DisplacementGrid> grids(const PixelWindow& tile, const PixelWindow& cover) const override {
        return scaled(seen_.grids(tile, cover, nearest_, farthest_));
    }
    std::vector<DisplacementGrid> every_pixel(const PixelWindow& window) const override {
        std::vector<DisplacementGrid> grids;
        grids.push_back(seen_.every_pixel(window, farthest_));
        return scaled(std::move(grids));
    }
    NodeLayout layout() const override { return {seen_.finest_spacing(), seen_.depths(nearest_, farthest_)}; }
    std::shared_ptr<const MediumInstant> air(const InstantSettings& settings) const override {
        return BlobsMedium::around(seen_.blobs(), settings);
    }
    std::optional<double> reach(bool judge) const override { return judge ? kJudgedBlobReach : kRayBlobReach; }
    bool chooses_own_steps() const override { return true; }
    bool is_dear() const override { return true; }

  private:
    std::vector<DisplacementGrid> scaled(std::vector<DisplacementGrid> grids) const {
        for (DisplacementGrid& grid : grids) grid.scale(static_cast<float>(gain_));
        return grids;
    }

    SeenBlobs seen_;
    double nearest_, farthest_, gain_;
};

}  // namespace

BlobsBend::BlobsBend(const ShotContext& shot, std::size_t medium, std::shared_ptr<const BlobsMedium> blobs)
    : MediumBend(shot, medium, shot.own_model(Model::FirstOrder)), blobs_(std::move(blobs)) {
    told_.note =
        fmt::format("{}: model {}, up to {} blobs at a time", name(),
                    shot.second_order() ? "second-order (through all media together)" : "first-order (closed form)",
                    blobs_->cloud().most());
}

std::string BlobsBend::why_unseen(const ShotContext& shot, const BlobsMedium& blobs) {
    const std::vector<BlobHome> homes = blobs.cloud().homes();
    const double negligible = shot.settings.negligible, deepest = shot.deepest();
    double strongest = 0;
    for (const BlobHome& home : homes) strongest = std::max(strongest, std::abs(home.largest.n));
    if (strongest == 0) return "no blob differs from the ambient temperature";
    // An upper bound wherever the blobs are: every blob counts as if it were at the camera.
    const double bound =
        largest_blob_shift({{}, 0, strongest}, shot.strength, shot.reference, 0, deepest) * blobs.cloud().most();
    if (bound == 0 || (!shot.camera_moves() && bound <= negligible))
        return fmt::format("its blobs move no pixel by more than {:.2g} px", bound);
    const auto seen = [&](const PixelWindow& pixels) {
        return may_be_seen(homes, shot.strength, shot.reference, pixels, deepest, negligible);
    };
    if (shot.camera_moves() || seen(shot.picture()) || (shot.settings.overscan && seen(shot.settings.overscan())))
        return {};
    return fmt::format(
        "none of its blobs moves a pixel of the picture by more than {:g} px: they are aside of it, or behind what is "
        "up to {:g} m away",
        negligible, deepest);
}

SeenBlobs BlobsBend::seen_at(const Camera& camera, double t, double farthest, double gain) const {
    return SeenBlobs(blobs_->cloud().at(t), shot_.strength, camera, farthest, gain);
}

std::unique_ptr<const BendInstant> BlobsBend::at(const FrameView& frame) const {
    return std::make_unique<const Instant>(seen_at(frame.camera, frame.t, frame.farthest, frame.gain), frame);
}

double BlobsBend::expected_variance(double D, bool rough) const {
    const BlobCloud& cloud = blobs_->cloud();
    if (rough && cloud.most() >= kManyBlobs) return shift_variance(D, 1, kRoughRays);
    return shift_variance(D, rms_instants(blobs_->spec(), cloud), kRmsRays);
}

double BlobsBend::shift_variance(double D, int instants, int rays) const {
    const RandomStream stream(1, "expected rms");
    const BlobsSpec& spec = blobs_->spec();
    const bool carried = !spec.sources.empty() && spec.wind && spec.wind->rms > 0;
    const int each = std::max(rays / instants, kFewestRmsPixels);
    double sum = 0;
    int tried = 0;
    for (int with_blobs = 0; tried < instants && !(carried && with_blobs == kMostRmsWinds); ++tried) {
        check_stop(shot_.settings.stop);
        const double t = tried == 0 ? 0 : 1e3 * stream.uniform((1ULL << 32) + static_cast<std::uint64_t>(tried));
        const SeenBlobs seen = seen_at(shot_.reference, t, D, 1);
        if (!seen.blobs().empty()) ++with_blobs;
        if (seen.seen().empty()) continue;
        const BlobPixels pixels(seen.seen(), shot_.reference, shot_.picture());
        for (int i = 0; i < each; ++i) {
            const auto [x, y, weight] = pixels.draw(stream, tried * each + i);
            const DisplacementGrid grid = seen.every_pixel({x, y, 1, 1}, D);
            GridRow row;
            row.start(grid, y);
            const Shift d = row.at(x, D);
            sum += weight * (double{d.x} * d.x + double{d.y} * d.y) / each;
        }
    }
    return sum / tried;
}

double BlobsBend::focusing_variance(double D) const {
    const SeenBlobs seen = seen_at(shot_.reference, 0, D, 1);
    const std::vector<SeenBlob>& blobs = seen.seen();
    if (blobs.empty()) return 0;
    const RandomStream stream(1, "focusing of blobs");
    const PixelWindow picture = shot_.picture();
    std::array<std::optional<double>, kBlobPairs> slopes;
    tbb::parallel_for(std::size_t{0}, kBlobPairs, [&](std::size_t i) {
        check_stop(shot_.settings.stop);
        const SeenBlob& blob =
            blobs[static_cast<std::size_t>(stream.uniform(4 * i) * static_cast<double>(blobs.size()))];
        const double scale = shot_.perspective() ? 1 / std::max(blob.forward, blob.sigma) : 1;
        const auto aside = [&](std::uint64_t c) { return (3 * stream.uniform(4 * i + c) - 1.5) * blob.sigma; };
        const dvec2 place = shot_.reference.pixel(scale * dvec2(blob.right + aside(1), blob.up + aside(2)));
        if (!(place.x >= 0 && place.x < picture.width && place.y >= 0 && place.y < picture.height)) return;
        const PixelPair pair(static_cast<int>(place.x), static_cast<int>(place.y), i % 2 == 0);
        slopes[i] = pair.shifts({seen.every_pixel(pair.window, D)}, D).slope;
    });
    double sum = 0;
    int pairs = 0;
    for (const std::optional<double>& slope : slopes) {
        if (!slope) continue;
        sum += *slope * *slope;
        ++pairs;
    }
    return pairs > 0 ? sum / pairs : 0;
}

double BlobsBend::instant_bytes() const {
    return static_cast<double>(sizeof(Blob) + sizeof(SeenBlob)) * blobs_->cloud().most();
}

}  // namespace eikonal
