#include "warp/displace/media/lattice/lattice_bend.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "noise/turbulence/parameters/turbulence_spec.h"
#include "warp/displace/media/ray_steps.h"
#include "warp/displace/models/first_order.h"
#include "warp/displace/models/lattice_tables.h"
#include "warp/displace/models/second_order.h"

namespace eikonal {
namespace {

/// kTableSplineError: allowed spline error of `table` and `tables`, relative to the rms. kNearestPadded: the nearest
/// object that the padding is chosen for, as a part of `far`.
constexpr double kTableSplineError = 1e-2, kNearestPadded = 0.05;
/// Allowed spline error of the rays that judge tables: kJudgedSplineError √v, relative to the rms, where v is the
/// focusing variance. This is about half of the second order, which these rays have to find.
constexpr double kJudgedSplineError = 0.125;
/// A lattice axis counts as the view's axis if 1 - cosine of the angle between them is less than this.
constexpr double kAligned = 1e-9;
/// table and tables treat rays as parallel to a lattice axis. They are refused if the view is more than 30 degrees from
/// it.
constexpr double kLeastAlignment = 0.866;
/// The finest spline of a warp, and its largest number of nodes. They do not depend on the machine's memory, so that
/// every machine makes the same picture.
constexpr int kMostPadding = 4;
constexpr double kMostNodes = 256.0 * 256 * 256;

SplineChoice warp_spline(const LatticeField& field, double slope_error) {
    return choose_spline(field, {.slope = slope_error, .most_padding = kMostPadding, .most_nodes = kMostNodes});
}

/// A lattice at one frame, by first-order rays. Maps and bent rays share the spline.
class RaysInstant final : public LaidOutInstant {
  public:
    RaysInstant(std::shared_ptr<const LatticeMedium> medium, std::shared_ptr<const LatticeInstant> spline,
                double bend_error, const FirstOrderRays& rays, const FrameView& frame)
        : LaidOutInstant(frame.camera, frame.gain),
          medium_(std::move(medium)),
          spline_(std::move(spline)),
          bend_error_(bend_error),
          rays_(rays) {
        lay_out({rays_.grid(frame.camera, frame.nearest, frame.farthest)});
    }
    std::shared_ptr<const MediumInstant> air(const InstantSettings&) const override {
        return lattice_medium_instant(spline_, medium_->field(), bend_error_);
    }
    std::optional<dvec3> averaged_cells() const override { return rays_.cell; }

  private:
    void fill(DisplacementGrid& grid) const override { rays_.fill(grid, camera(), *spline_); }

    std::shared_ptr<const LatticeMedium> medium_;
    std::shared_ptr<const LatticeInstant> spline_;
    double bend_error_;
    FirstOrderRays rays_;
};

/// A lattice at one frame, by tables. The rays that judge the tables get a spline of their own.
class TablesInstant final : public LaidOutInstant {
  public:
    TablesInstant(std::shared_ptr<const LatticeMedium> medium, DisplacementTables tables, const Padding& ray_padding,
                  const dvec3& cell, const FrameView& frame)
        : LaidOutInstant(frame.camera, frame.gain),
          medium_(std::move(medium)),
          tables_(std::move(tables)),
          ray_padding_(ray_padding),
          cell_(cell),
          t_(frame.t) {
        lay_out({tables_.grid(frame.camera)});
    }
    std::shared_ptr<const MediumInstant> air(const InstantSettings&) const override {
        const LatticeField& field = medium_->field();
        return lattice_medium_instant(std::make_shared<const LatticeInstant>(field, t_, ray_padding_), field, 0);
    }
    std::optional<dvec3> averaged_cells() const override { return cell_; }

  private:
    void fill(DisplacementGrid& grid) const override { tables_.fill(grid, camera()); }

    std::shared_ptr<const LatticeMedium> medium_;
    DisplacementTables tables_;
    Padding ray_padding_;
    dvec3 cell_;
    double t_;  ///< [s]
};

/// The model of a lattice, and the reason for it.
struct ChosenModel {
    Model model;
    std::string why;
};
ChosenModel choose_lattice_model(const ShotContext& shot, const std::string& medium, const TurbulenceSpec& spec) {
    const PathRays rays = nearest_axis(shot.reference, shot.scene.optics.aperture);
    const bool aligned = 1 - axis_alignment(shot.reference, rays) < kAligned && !shot.camera_moves();
    const bool falloff_across = !spec.falloff || std::abs(spec.falloff->normal[rays.axis]) < 1e-9;
    const bool spectral_applies = !shot.perspective() && aligned && falloff_across;
    const char* obstacle = shot.perspective()    ? "the camera is perspective"
                           : shot.camera_moves() ? "the camera moves"
                           : !aligned            ? "the view is not along a lattice axis"
                           : !falloff_across     ? "the falloff varies along the view"
                                                 : "orthographic view along a lattice axis";
    if (shot.second_order()) return {Model::SecondOrder, "through all media together"};
    if (!shot.settings.model || *shot.settings.model == Model::Screens)
        return {spectral_applies ? Model::Spectral : Model::FirstOrder, obstacle};
    const Model model = *shot.settings.model;
    if (model == Model::Spectral && !spectral_applies)
        throw UserError(
            fmt::format("`model` spectral: {} needs an orthographic camera that looks along x, y or z, and a falloff "
                        "across the view, but here {}; use `model` first-order or tables",
                        medium, obstacle));
    if (model != Model::FirstOrder && !falloff_across)
        throw UserError(fmt::format(
            "`model` {}: the falloff of {} varies along the view, which tables cannot hold; use `model` first-order",
            name_of(model), medium));
    if (model != Model::FirstOrder && axis_alignment(shot.reference, rays) < kLeastAlignment)
        throw UserError(
            fmt::format("`model` {}: the view is more than 30 degrees from every lattice axis; use `model` first-order",
                        name_of(model)));
    return {model, "chosen"};
}

}  // namespace

LatticeBend::LatticeBend(const ShotContext& shot, std::size_t medium, std::shared_ptr<const LatticeMedium> lattice)
    : MediumBend(shot, medium,
                 choose_lattice_model(shot, fmt::format("medium.{}", medium), lattice->field().spec()).model),
      lattice_(std::move(lattice)),
      rays_(nearest_axis(shot.reference, shot.scene.optics.aperture)) {
    const LatticeField& field = lattice_->field();
    const LatticeGeometry& g = field.geometry();
    cell_ = {g.spacing(0), g.spacing(1), g.spacing(2)};
    if (stepped())
        if (std::string warning = check_steps(shot, name(), cell_); !warning.empty())
            told_.first_warnings.push_back(std::move(warning));
    told_.note = fmt::format("{}: model {} ({}): lattice {} x {} x {} x {}, periods {:g} x {:g} x {:g} m, {:g} s",
                             name(), name_of(model()), choose_lattice_model(shot, name(), field.spec()).why, g.size[0],
                             g.size[1], g.size[2], g.size[3], g.period[0], g.period[1], g.period[2], g.period[3]);
    if (stepped())
        choose_ray_spline();
    else
        choose_table_padding();
    const double far = shot.settings.far;
    if (model() == Model::Table) {
        const auto x1 = field.displacement_variance(rays_.axis, far, rays_.aperture);
        const auto force = slice_variance(field, rays_);
        const double f2 = force[0] + force[1];
        constant_ = f2 > 0 ? std::sqrt((x1[0] + x1[1]) / f2) / far : 0;
    }
    if (const double period = g.period[static_cast<std::size_t>(rays_.axis)]; far > period)
        told_.last_warnings.push_back(fmt::format(
            "{}: the path of {:g} m is longer than the lattice period of {:g} m along it, beyond which the field "
            "repeats and displacement is overstated; use form=\"screens\", `far` or a longer period",
            name(), far, period));
}

void LatticeBend::choose_ray_spline() {
    const double allowed = shot_.second_order() ? kSecondOrderSplineError : kFirstOrderSplineError;
    const SplineChoice spline = warp_spline(lattice_->field(), allowed);
    padding_ = ray_padding_ = spline.padding;
    if (!spline.within)
        told_.first_notes.push_back(
            fmt::format("{}: too large a lattice for a finer spline, whose force is off by {:.2g} of its rms", name(),
                        spline.error.slope));
    // An aperture of at least a cell averages this error out.
    if (shot_.scene.optics.aperture * padding_ < std::min({cell_.x, cell_.y, cell_.z})) bend_error_ = spline.error.bend;
}

void LatticeBend::choose_table_padding() {
    const LatticeField& field = lattice_->field();
    const std::array paths{kNearestPadded * shot_.settings.far, shot_.settings.far};
    padding_ = path_padding(field, rays_, paths, model() == Model::Spectral ? kPathTableError : kTableSplineError);
    if (!shot_.settings.sample_errors) return;
    const double order = kJudgedSplineError * std::sqrt(focusing_variance(shot_.settings.far));
    ray_padding_ = warp_spline(field, std::max(kFirstOrderSplineError, order)).padding;
}

std::unique_ptr<const BendInstant> LatticeBend::tables_at(const FrameView& frame) const {
    const LatticeField& field = lattice_->field();
    const double far = shot_.settings.far, way = std::max(frame.farthest, far);
    const PathRays rays = nearest_axis(frame.camera, shot_.scene.optics.aperture);
    const auto exact = [&](const std::vector<double>& depths, DepthInterpolation interpolation) {
        return exact_instant(field, frame.t, rays, depths, interpolation, shot_.strength, padding_);
    };
    Padding ray_padding{ray_padding_, ray_padding_, ray_padding_};
    // All rays run along one axis. The spline's error along it averages out over the path.
    if (model() == Model::Spectral) ray_padding[static_cast<std::size_t>(nearest_axis(shot_.reference, 0).axis)] = 1;
    const auto made = [&](DisplacementTables tables) {
        return std::make_unique<const TablesInstant>(lattice_, std::move(tables), ray_padding, cell_, frame);
    };
    if (model() == Model::Table)
        return made(slice_instant(field, frame.t, rays, far, constant_, shot_.strength, padding_));
    if (model() == Model::Spectral)
        return made(exact(spectral_depths(field, rays, frame.nearest, frame.farthest), DepthInterpolation::Hermite));
    std::vector<double> depths;
    for (int k = 1; k <= kTables; ++k) depths.push_back(way * k / kTables);
    return made(exact(depths, DepthInterpolation::Linear));
}

std::unique_ptr<const BendInstant> LatticeBend::at(const FrameView& frame) const {
    if (!stepped()) return tables_at(frame);
    const DisplacerSettings& settings = shot_.settings;
    if (shot_.camera_moves() || is_beyond(frame.farthest, settings.far))
        check_frame_steps(shot_, name(), cell_, frame.camera, std::max(frame.farthest, settings.far));
    return std::make_unique<const RaysInstant>(
        lattice_, std::make_shared<const LatticeInstant>(lattice_->field(), frame.t, padding_), bend_error_,
        FirstOrderRays{shot_.strength, cell_, shot_.scene.optics.aperture, settings.far, settings.stop}, frame);
}

double LatticeBend::expected_variance(double D, bool) const {
    const double pixels = shot_.pixels_per_metre(D), aspect = shot_.reference.pixel_aspect;
    const auto x1 = lattice_->field().displacement_variance(rays_.axis, D, rays_.aperture);
    return shot_.strength * shot_.strength * 0.5 * (1 + aspect * aspect) * (x1[0] + x1[1]) * pixels * pixels;
}

double LatticeBend::focusing_variance(double D) const {
    const auto slope = lattice_->field().focusing_variance(rays_.axis, D, shot_.perspective(), rays_.aperture);
    return shot_.strength * shot_.strength * 0.5 * (slope[0] + slope[1]);
}

double LatticeBend::corner_gain() const {
    return stepped() ? MediumBend::corner_gain() : 1;  // tables treat all rays as parallel
}

double LatticeBend::instant_bytes() const {
    const LatticeGeometry& g = lattice_->field().geometry();
    const auto axis = static_cast<std::size_t>(nearest_axis(shot_.reference, 0).axis);
    const double samples = static_cast<double>(g.spatial_samples()), padding = padding_;
    // a spline of the whole lattice, or at most four tables at each of the depths
    return stepped() ? 2 * sizeof(float) * samples * padding * padding * padding
                     : 4 * sizeof(float) * samples / g.size[axis] * padding * padding * kMostSpectralDepths;
}

std::vector<std::string> LatticeBend::beyond_far(double farthest) const {
    std::vector<std::string> lines;
    if (stepped())
        if (std::string line = many_steps_beyond(shot_, name(), cell_, farthest, model()); !line.empty())
            lines.push_back(std::move(line));
    const double period = lattice_->field().geometry().period[static_cast<std::size_t>(rays_.axis)];
    if (shot_.settings.far <= period && farthest > period)
        lines.push_back(
            fmt::format("{}: the lattice's period of {:g} m along the path repeats, and displacement is overstated",
                        name(), period));
    return lines;
}

}  // namespace eikonal
