#include "noise/air/air.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "noise/base/error.h"
#include "noise/blobs/blobs.h"
#include "noise/math/portable_math.h"
#include "noise/math/ray_bounds.h"
#include "noise/medium/refractivity.h"
#include "noise/profile/profile.h"
#include "noise/surface/surface.h"
#include "noise/turbulence/gradient_noise/gradient_noise.h"
#include "noise/turbulence/lattice/lattice_instant.h"
#include "noise/turbulence/screens/screen_force.h"

namespace eikonal {
namespace {

/// A step is at most this part of a feature's size.
constexpr double kPartOfCell = 0.5, kPartOfDropoff = 0.25, kPartOfProfile = 0.125;
/// So many longest steps are one of a method that controls its error.
constexpr double kStride = 2, kLatticeStride = 3;
/// Beyond this change of the index there is no speaking of first order.
constexpr double kStraightest = 0.5;
/// Of the whole way: what a straight walk over the ends of slabs may lose to rounding.
constexpr double kWalked = 1e-12;
/// Bytes a node of a snapshot while it is made: its spectrum, samples and coefficients; and the most that a spline is
/// made finer for, whatever the machine has, so that every machine makes the same.
constexpr double kSnapshotBytes = 12, kMostSplineBytes = 3.3e9;

// Every medium at an instant has sample(x) and jet(x), without exaggeration, and longest_step(x, d), clear_way(x, d)
// and way_to_edge(x, d) as AirInstant's. (Thin screens have force and force_jet instead.)

/// Where turbulence with a falloff, or none, is. Without one it is everywhere.
struct TurbulenceBounds {
    std::optional<Falloff> falloff;
    double step;

    double height(const dvec3& x) const { return glm::dot(x - falloff->origin, falloff->normal); }
    double top() const { return -falloff->length * portable::log(kNegligibleIndex); }

    double longest_step(const dvec3& x, const dvec3&) const {
        return step + (falloff ? std::max(0.0, height(x) - top()) : 0.0);
    }
    double clear_way(const dvec3& x, const dvec3& d) const {
        return falloff ? way_into_layer(height(x), glm::dot(d, falloff->normal), -kNever, top()) : 0;
    }
    double way_to_edge(const dvec3& x, const dvec3& d) const {
        return falloff ? way_to_plane(height(x), glm::dot(d, falloff->normal)) : kNever;
    }
};

struct LatticeMediumInstant : TurbulenceBounds {
    std::shared_ptr<const LatticeInstant> snapshot;
    double bend_error;

    IndexSample sample(const dvec3& x) const { return snapshot->smooth_sample(x); }
    IndexJet jet(const dvec3& x) const { return snapshot->jet(x); }
};

struct NoiseInstant : TurbulenceBounds {
    const GradientNoiseField* field;
    double t;

    IndexSample sample(const dvec3& x) const { return field->sample(x, t); }
    IndexJet jet(const dvec3& x) const { return field->jet(x, t); }
};

struct SurfaceInstant {
    const SurfaceIndex* layer;
    double bend;  ///< the layer's largest |F| [1/m]
    double part;  ///< of the dropoff

    IndexSample sample(const dvec3& x) const { return layer->sample(x); }
    IndexJet jet(const dvec3& x) const { return layer->jet(x); }
    /// A step may change the height by a part of the dropoff, growing above the layer's knee; over s metres of way it
    /// does so by at most climb s + bend s²/2.
    double longest_step(const dvec3& x, const dvec3& d) const {
        const double h = layer->height(x), within = std::clamp(h, 0.0, layer->top());
        const double change = part * (layer->dropoff() + std::max(0.0, within - layer->knee()));
        const double climb = std::abs(layer->climb(d));
        return std::abs(h - within) + 2 * change / (climb + std::sqrt(climb * climb + 2 * bend * change));
    }
    double clear_way(const dvec3& x, const dvec3& d) const {
        return way_into_layer(layer->height(x), layer->climb(d), 0, layer->top());
    }
    double way_to_edge(const dvec3& x, const dvec3& d) const { return way_to_plane(layer->height(x), layer->climb(d)); }
};

struct BlobsInstant {
    BlobInstant blobs;
    double factor;  ///< F/∇(n - n_ambient) where n is the ambient's, this medium's exaggeration in it
    double square;  ///< what it is off by at most, relative, for an n - n_ambient of 1

    IndexSample sample(const dvec3& x) const { return blobs.sample(x); }
    IndexJet jet(const dvec3& x) const { return blobs.jet(x); }
    double longest_step(const dvec3& x, const dvec3&) const { return blobs.longest_step(x); }
    double longest_stride(const dvec3& x, const dvec3& d, double turn) const {
        return blobs.longest_stride(x, d, turn / std::abs(factor));
    }
    double clear_way(const dvec3& x, const dvec3& d) const { return blobs.clear_way(x, d); }
    double way_to_edge(const dvec3&, const dvec3&) const { return kNever; }
};

struct ProfileInstant {
    const Profile* profile;

    IndexSample sample(const dvec3& x) const {
        const IndexJet jet = profile->jet(x);
        return {jet.n, jet.gradient};
    }
    IndexJet jet(const dvec3& x) const { return profile->jet(x); }
    double longest_step(const dvec3& x, const dvec3&) const { return kPartOfProfile * profile->scale(x); }
    double clear_way(const dvec3& x, const dvec3& d) const { return profile->clear_way(x, d); }
    double way_to_edge(const dvec3& x, const dvec3& d) const { return profile->way_to_edge(x, d); }
};

struct LatticeMedium {
    LatticeField field;
    int padding;
    double bend_error;
};
struct ScreenMedium {
    ScreenField field;
    std::optional<Falloff> falloff;
};
using Medium = std::variant<LatticeMedium, GradientNoiseField, ScreenMedium, SurfaceIndex, BlobCloud, Profile>;
using AnyInstant = std::variant<LatticeMediumInstant, NoiseInstant, SurfaceInstant, BlobsInstant, ProfileInstant>;

/// A medium and what its n - n_ambient is multiplied by, beside the exaggeration.
struct Instant {
    AnyInstant medium;
    double weight = 1;
};

/// What turns the sum of the media into force.
struct Laws {
    RayEquation equation = RayEquation::Physical;
    double ambient = 0;  ///< n_a - 1
    double exaggeration = 1;

    /// What multiplies ∇(n_i - n_ambient) where n is near 1.
    double strength() const { return exaggeration * (equation == RayEquation::Paper ? 0.5 : 1); }
    /// |dx/du| where the index is 1 + n.
    double speed(double n) const {
        const double index = std::max(0.0, 1 + n);
        return equation == RayEquation::Paper ? std::sqrt(index) : index;
    }
};

bool has_strength(const TurbulenceSpec& spec) {
    return (spec.spectrum == SpectrumKind::VonKarman ? spec.cn2 : spec.strength) != 0;
}

double lattice_step(const LatticeField& field) {
    const LatticeGeometry& g = field.geometry();
    double finest = std::min({g.spacing(0), g.spacing(1), g.spacing(2)});
    if (field.spec().spectrum == SpectrumKind::VonKarman) finest = std::max(finest, 0.5 * field.spec().inner_scale);
    return kPartOfCell * finest;
}

}  // namespace

struct AirInstant::State {
    std::shared_ptr<const void> owner;  ///< of what the media point to
    Laws laws;
    std::vector<Instant> media;
    std::vector<ScreenForce> screens;

    /// n and its derivatives, absolute but for n's 1; no derivatives where n <= 0.
    template <class Jet, class Take>
    Jet sum(Take&& take) const {
        Jet total{};
        for (const Instant& i : media) std::visit([&](const auto& m) { add(total, take(m), i.weight); }, i.medium);
        total.n = laws.ambient + laws.exaggeration * total.n;
        if (!(total.n > -1)) return Jet{std::max(total.n, -kLargestIndex)};
        scale(total, laws.exaggeration);
        return total;
    }
    IndexSample sample(const dvec3& x) const {
        return sum<IndexSample>([&](const auto& m) { return m.sample(x); });
    }
    IndexJet jet(const dvec3& x) const {
        return sum<IndexJet>([&](const auto& m) { return m.jet(x); });
    }

    /// The least of what every medium and its screens say.
    template <class Ask>
    double least(Ask&& ask) const {
        double result = kNever;
        for (const Instant& i : media) std::visit([&](const auto& m) { result = std::min(result, ask(m)); }, i.medium);
        for (const ScreenForce& s : screens) result = std::min(result, ask(s));
        return result;
    }

    void add(FieldPart part) {
        const double weight = part.weight;
        if (auto* lattice = std::get_if<LatticePart>(&part.medium)) {
            media.push_back({LatticeMediumInstant{{lattice->field->spec().falloff, lattice_step(*lattice->field)},
                                                  std::move(lattice->snapshot),
                                                  lattice->bend_error},
                             weight});
        } else if (const auto* noise = std::get_if<NoisePart>(&part.medium)) {
            media.push_back(
                {NoiseInstant{
                     {noise->field->falloff(), kPartOfCell * noise->field->smallest_cell()}, noise->field, noise->t},
                 weight});
        } else if (auto* thin = std::get_if<ScreensPart>(&part.medium)) {
            screens.emplace_back(*thin->field, std::move(thin->screens), thin->frame, thin->falloff,
                                 weight * laws.strength());
        } else if (const auto* surface = std::get_if<SurfacePart>(&part.medium)) {
            const SurfaceIndex& layer = *surface->layer;
            const double n = 1 + laws.ambient + std::max(0.0, laws.exaggeration * weight * layer.above_ambient(0));
            media.push_back({SurfaceInstant{&layer, std::abs(weight * laws.strength()) * layer.largest_slope() * n,
                                            kPartOfDropoff * surface->step},
                             weight});
        } else {
            const auto& [blobs, reach, step] = std::get<BlobsPart>(part.medium);
            const double strength = weight * laws.strength();
            const double n = laws.equation == RayEquation::Paper ? 1 : 1 + laws.ambient;
            media.push_back(
                {BlobsInstant{BlobInstant(blobs, reach, kBlobStep * step), strength * n, std::abs(strength)}, weight});
        }
    }

  private:
    static void add(IndexSample& a, const IndexSample& b, double weight) {
        a.n += weight * b.n;
        a.gradient += weight * b.gradient;
    }
    static void add(IndexJet& a, const IndexJet& b, double weight) {
        a.n += weight * b.n;
        a.gradient += weight * b.gradient;
        a.hessian += weight * b.hessian;
    }
    static void scale(IndexSample& a, double factor) { a.gradient *= factor; }
    static void scale(IndexJet& a, double factor) {
        a.gradient *= factor;
        a.hessian *= factor;
    }
};

AirInstant::AirInstant(std::unique_ptr<State> state) : state_(std::move(state)) {}
AirInstant::AirInstant(AirInstant&&) noexcept = default;
AirInstant& AirInstant::operator=(AirInstant&&) noexcept = default;
AirInstant::~AirInstant() = default;

dvec3 AirInstant::force(const dvec3& x, const dvec3& p) const {
    return motion(x, p).force;
}

AirInstant::Motion AirInstant::motion(const dvec3& x, const dvec3& p) const {
    const IndexSample s = state_->sample(x);
    Motion m{(state_->laws.equation == RayEquation::Paper ? 0.5 : 1 + s.n) * s.gradient, state_->laws.speed(s.n)};
    for (const ScreenForce& screens : state_->screens) m.force += screens.force(x, p);
    return m;
}

ForceJet AirInstant::force_jet(const dvec3& x, const dvec3& p) const {
    const IndexJet s = state_->jet(x);
    ForceJet result;
    if (state_->laws.equation == RayEquation::Paper) {
        result.force = 0.5 * s.gradient;
        result.by_position = 0.5 * s.hessian;
    } else {
        result.force = (1 + s.n) * s.gradient;
        result.by_position = (1 + s.n) * s.hessian + glm::outerProduct(s.gradient, s.gradient);
    }
    for (const ScreenForce& screens : state_->screens) {
        const ForceJet jet = screens.force_jet(x, p);
        result.force += jet.force;
        result.by_position += jet.by_position;
        result.by_direction += jet.by_direction;
    }
    return result;
}

double AirInstant::refractivity(const dvec3& x) const {
    return state_->sample(x).n;
}

double AirInstant::speed(const dvec3& x) const {
    return state_->laws.speed(refractivity(x));
}

double AirInstant::longest_step(const dvec3& x, const dvec3& d) const {
    return state_->least([&](const auto& m) { return m.longest_step(x, d); });
}

double AirInstant::longest_step(const dvec3& x) const {
    // only a surface tells directions apart, and its shortest step is that along its normal
    return state_->least([&](const auto& m) {
        if constexpr (std::is_same_v<std::decay_t<decltype(m)>, SurfaceInstant>)
            return m.longest_step(x, m.layer->normal());
        else
            return m.longest_step(x, dvec3(0));
    });
}

double AirInstant::longest_stride(const dvec3& x, const dvec3& d, double turn) const {
    return state_->least([&](const auto& m) {
        using M = std::decay_t<decltype(m)>;
        if constexpr (std::is_same_v<M, BlobsInstant>)
            return m.longest_stride(x, d, turn);
        else if constexpr (std::is_same_v<M, LatticeMediumInstant>)
            return kLatticeStride * m.longest_step(x, d);
        else
            return kStride * m.longest_step(x, d);
    });
}

std::optional<AirInstant::Pull> AirInstant::pull(const dvec3& x, const dvec3& d, double distance, double turn) const {
    Pull sum;
    for (const Instant& medium : state_->media) {
        const auto* blobs = std::get_if<BlobsInstant>(&medium.medium);
        if (!blobs) return {};
        const BlobInstant::Bend bend = blobs->blobs.bend(x, d, distance, turn / std::abs(blobs->factor));
        sum.value += blobs->factor * bend.x1;
        sum.error += blobs->square * bend.largest;
    }
    // F is constant along a straight ray within a slab.
    for (const ScreenForce& screens : state_->screens) {
        for (double w = 0; w < distance;) {
            const double way = std::min(screens.way_to_edge(x + w * d, d), distance - w);
            sum.value += way * (distance - w - 0.5 * way) * screens.force(x + (w + 0.5 * way) * d, d);
            w += way + kWalked * distance;
        }
    }
    if (!(sum.error < kStraightest)) return {};
    return sum;
}

double AirInstant::clear_way(const dvec3& x, const dvec3& d) const {
    return state_->least([&](const auto& m) { return m.clear_way(x, d); });
}

double AirInstant::way_to_edge(const dvec3& x, const dvec3& d) const {
    return state_->least([&](const auto& m) { return m.way_to_edge(x, d); });
}

AirInstant::Interpolation AirInstant::interpolation(const dvec3& from, const dvec3& to) const {
    // Errors at places apart are independent: squares add up, ∫ (1 - s)² g² ds and ∫ g² ds by the midpoint rule.
    constexpr int kParts = 32;
    const double distance = glm::distance(from, to);
    double shift = 0, turn = 0;
    for (const Instant& medium : state_->media) {
        const auto* lattice = std::get_if<LatticeMediumInstant>(&medium.medium);
        if (!lattice || lattice->bend_error == 0) continue;
        const double bend = medium.weight * state_->laws.strength() * lattice->bend_error;
        for (int i = 0; i < kParts; ++i) {
            const double s = (i + 0.5) / kParts;
            const double g = lattice->falloff ? falloff_at(*lattice->falloff, from + s * (to - from)).n : 1;
            const double part = bend * bend * g * g * distance / kParts;
            turn += part;
            shift += (1 - s) * (1 - s) * part;
        }
    }
    return {std::sqrt(shift) * distance, std::sqrt(turn)};
}

struct Air::State {
    Laws laws;
    std::optional<ShotFrame> frame;
    std::uint64_t memory;  ///< left of what is allowed
    double bend_error;     ///< allowed [m^-1/2]
    double interpolation_error = 0;
    double blobs = 0;  ///< at a time, of the media so far
    std::vector<Medium> media;
    std::vector<std::string> notes;

    void take(std::uint64_t bytes) { memory -= std::min(memory, bytes); }

    // Each adds a medium, and says what has become of it.
    std::string add(const TurbulenceSpec& spec) {
        if (!has_strength(spec)) return "left out, its strength is zero";
        switch (spec.form) {
            case TurbulenceForm::Lattice:
                return add_lattice(spec);
            case TurbulenceForm::GradientNoise:
                media.emplace_back(GradientNoiseField(spec));
                return "gradient noise, not periodic";
            case TurbulenceForm::Screens:
                break;
        }
        if (!frame) throw std::logic_error("Air: thin screens without a frame");
        std::vector<ScreenGeometry> geometry = layout_screens(spec, frame->view);
        check_screens(spec, geometry, memory);
        take(screens_bytes(spec, geometry));
        const ScreenGeometry middle = geometry[geometry.size() / 2];
        std::string note = fmt::format("{} thin screens of {} x {} x {} samples, {:.3g} m apart", geometry.size(),
                                       middle.nx, middle.ny, middle.nt, middle.thickness);
        media.emplace_back(ScreenMedium{ScreenField(spec, std::move(geometry), frame->right, frame->up), spec.falloff});
        return note;
    }

    std::string add_lattice(const TurbulenceSpec& spec) {
        const LatticeGeometry geometry = choose_lattice(spec);
        check_lattice(spec, geometry, memory);
        take(lattice_bytes(spec, geometry));
        LatticeField field(spec, geometry);
        int padding = 1;
        const auto bytes = [&](int p) {
            return p > 1 ? kSnapshotBytes * static_cast<double>(geometry.spatial_samples()) * p * p * p : 0.0;
        };
        SplineError error = lattice_spline_error(field, padding);
        const auto fine = [&] {
            return error.slope <= kInterpolationError && error.bend * std::abs(laws.strength()) <= bend_error;
        };
        for (const int p : {2, 3, 4, 5, 6, kFinestPadding}) {
            if (fine() || bytes(p) > kMostSplineBytes) break;
            padding = p;
            error = lattice_spline_error(field, p);
        }
        if (bytes(padding) > static_cast<double>(memory))
            throw UserError(
                fmt::format("lattice {} x {} x {}: its spline, {} times finer, needs {:.1f} GB of memory and {:.1f} GB "
                            "are free for it; choose a smaller lattice",
                            geometry.size[0], geometry.size[1], geometry.size[2], padding, bytes(padding) / 1e9,
                            static_cast<double>(memory) / 1e9));
        take(static_cast<std::uint64_t>(bytes(padding)));
        interpolation_error = std::max(interpolation_error, error.slope);
        media.emplace_back(LatticeMedium{std::move(field), padding, error.bend});
        return fmt::format(
            "lattice {} x {} x {} x {}, its spline {} times finer, whose force is off by {:.2g} of its rms{}",
            geometry.size[0], geometry.size[1], geometry.size[2], geometry.size[3], padding, error.slope,
            fine() ? "" : "; no finer one is made");
    }

    std::string add(const SurfaceSpec& spec, const IndexLaw& law) {
        SurfaceIndex layer(spec, law);
        if (!layer.bends()) return "left out, the surface is at ambient temperature";
        std::string note =
            fmt::format("{} surface, a layer {:.3g} m high", layer.above_ambient(0) < 0 ? "hot" : "cold", layer.top());
        media.emplace_back(std::move(layer));
        return note;
    }

    std::string add(const BlobsSpec& spec, const IndexLaw& law, const std::string& name) {
        BlobCloud cloud(spec, law, name, blobs);
        blobs += cloud.most();
        if (!(cloud.most() > 0)) return "left out, it has no blobs";
        std::string note = fmt::format("up to {} blobs at a time", cloud.most());
        media.emplace_back(std::move(cloud));
        return note;
    }
};

Air::Air(const std::vector<MediumSpec>& media, const OpticsSpec& optics, const std::optional<ShotFrame>& frame,
         std::uint64_t memory_limit, double bend_error)
    : state_(std::make_shared<State>()) {
    const IndexLaw law = index_law(optics);
    state_->laws = {optics.ray_equation, law.ambient(), optics.exaggeration};
    state_->frame = frame;
    state_->memory = memory_limit;
    state_->bend_error = bend_error;
    for (std::size_t i = 0; i < media.size(); ++i) {
        if (const auto* profile = std::get_if<ProfileSpec>(&media[i])) {
            if (media.size() > 1)
                throw UserError(
                    fmt::format("medium.{}: a profile is the absolute index of all space and stands alone; remove it "
                                "or the other {}",
                                i, media.size() == 2 ? "medium" : "media"));
            state_->laws = {optics.ray_equation, 0, 1};
            state_->media.emplace_back(Profile(*profile));
            state_->notes.emplace_back("medium.0: a profile, the absolute index of all space");
            return;
        }
        const std::string name = fmt::format("medium.{}", i);
        std::string note = "left out, optics.exaggeration is zero";
        if (optics.exaggeration != 0) {
            if (const auto* blobs = std::get_if<BlobsSpec>(&media[i])) note = state_->add(*blobs, law, name);
            if (const auto* surface = std::get_if<SurfaceSpec>(&media[i])) note = state_->add(*surface, law);
            if (const auto* turbulence = std::get_if<TurbulenceSpec>(&media[i])) {
                try {
                    note = state_->add(*turbulence);
                } catch (const UserError& error) {
                    throw UserError(name + ": " + error.what());
                }
            }
        }
        state_->notes.push_back(name + ": " + note);
    }
}

Air::~Air() = default;
Air::Air(Air&&) noexcept = default;

AirInstant::AirInstant(const OpticsSpec& optics, std::vector<FieldPart> parts) : state_(std::make_unique<State>()) {
    state_->laws = {optics.ray_equation, index_law(optics).ambient(), optics.exaggeration};
    for (FieldPart& part : parts) state_->add(std::move(part));
}

AirInstant Air::at(double t) const {
    auto instant = std::make_unique<AirInstant::State>();
    instant->owner = state_;
    instant->laws = state_->laws;
    for (const Medium& medium : state_->media) {
        if (const auto* lattice = std::get_if<LatticeMedium>(&medium))
            instant->add({LatticePart{&lattice->field,
                                      std::make_shared<const LatticeInstant>(lattice->field, t, lattice->padding),
                                      lattice->bend_error}});
        else if (const auto* noise = std::get_if<GradientNoiseField>(&medium))
            instant->add({NoisePart{noise, t}});
        else if (const auto* screens = std::get_if<ScreenMedium>(&medium))
            instant->add({ScreensPart{&screens->field, screens->field.at(t), *state_->frame, screens->falloff}});
        else if (const auto* surface = std::get_if<SurfaceIndex>(&medium))
            instant->add({SurfacePart{surface}});
        else if (const auto* cloud = std::get_if<BlobCloud>(&medium))
            instant->add({BlobsPart{cloud->at(t)}});
        else
            instant->media.push_back({ProfileInstant{&std::get<Profile>(medium)}});
    }
    return AirInstant(std::move(instant));
}

bool Air::bends() const {
    return !state_->media.empty();
}

const std::vector<std::string>& Air::notes() const {
    return state_->notes;
}

double Air::interpolation_error() const {
    return state_->interpolation_error;
}

}  // namespace eikonal
