#include "warp/displace/models/lattice_tables.h"

#include <algorithm>
#include <cmath>

#include "noise/turbulence/lattice/lattice_instant.h"

namespace eikonal {
namespace {

dvec3 unit(int axis) {
    dvec3 e{0, 0, 0};
    e[axis] = 1;
    return e;
}

/// Where a row of nodes reads the tables: evenly spaced points on a line in the lateral plane [m].
struct TableLine {
    dvec3 first, step;  ///< world
};

TableLine table_line(const Camera& camera, const DisplacementGrid& grid, double py, double depth) {
    const double px = grid.column0 * grid.spacing + 0.5;
    const StraightRay a = straight_ray(camera, px, py), b = straight_ray(camera, px + grid.spacing, py);
    const double z = grid.perspective ? kCentroid * depth : 0.0;
    return {a.at(z), b.at(z) - a.at(z)};
}

/// Samples a pair of tables along a line into interleaved (e1, e2), with falloff applied through the potential.
class LineSampler {
  public:
    LineSampler(const DisplacementTables& model, const TableLine& line, int n)
        : model_(model), line_(line), n_(n), values_(static_cast<std::size_t>(n)) {
        const auto axes = model.rays.lateral();
        for (int i = 0; i < 2; ++i) {
            start_[i] = line.first[axes[i]] / model.lateral_period[i];
            step_[i] = line.step[axes[i]] / model.lateral_period[i];
        }
    }

    void sample(const std::array<PeriodicSpline2, 2>& pair, const std::optional<PeriodicSpline2>& potential,
                std::vector<float>& out) {
        out.assign(2 * static_cast<std::size_t>(n_), 0.0f);
        for (int i = 0; i < 2; ++i) {
            read(pair[static_cast<std::size_t>(i)]);
            for (int c = 0; c < n_; ++c)
                out[2 * static_cast<std::size_t>(c) + static_cast<std::size_t>(i)] =
                    values_[static_cast<std::size_t>(c)];
        }
        if (!potential) return;
        read(*potential);
        const auto axes = model_.rays.lateral();
        for (int c = 0; c < n_; ++c) {
            const IndexSample g = falloff_at(*model_.falloff, line_.first + static_cast<double>(c) * line_.step);
            for (int i = 0; i < 2; ++i) {
                float& v = out[2 * static_cast<std::size_t>(c) + static_cast<std::size_t>(i)];
                v = static_cast<float>(g.n) * v +
                    static_cast<float>(g.gradient[axes[i]]) * values_[static_cast<std::size_t>(c)];
            }
        }
    }

  private:
    void read(const PeriodicSpline2& spline) {
        std::fill(values_.begin(), values_.end(), 0.0f);
        spline.add_values(start_[0], start_[1], step_[0], step_[1], n_, 1.0f, values_.data());
    }

    const DisplacementTables& model_;
    TableLine line_;
    int n_;
    std::array<double, 2> start_{}, step_{};
    std::vector<float> values_;
};

}  // namespace

PathRays nearest_axis(const Camera& camera, double aperture) {
    PathRays rays;
    for (int a = 0; a < 3; ++a)
        if (std::abs(camera.forward[a]) > std::abs(camera.forward[rays.axis])) rays.axis = a;
    rays.sign = camera.forward[rays.axis] < 0 ? -1 : 1;
    rays.z0 = camera.position[rays.axis];
    rays.aperture = aperture;
    return rays;
}

double axis_alignment(const Camera& camera, const PathRays& rays) {
    return std::abs(camera.forward[rays.axis]);
}

std::vector<double> spectral_depths(const LatticeField& field, const PathRays& rays, double nearest, double farthest) {
    if (!(farthest > nearest)) return {nearest};
    const double cells = (farthest - nearest) / field.geometry().spacing(rays.axis);
    const int intervals = std::clamp(static_cast<int>(std::ceil(std::min(cells, 1e6))), 1, kMostSpectralDepths - 1);
    std::vector<double> depths;
    for (int i = 0; i <= intervals; ++i)
        depths.push_back(i == intervals ? farthest : nearest + (farthest - nearest) * i / intervals);
    return depths;
}

namespace {

DisplacementTables blank(const LatticeField& field, const PathRays& rays, DepthInterpolation interpolation,
                         double strength) {
    const auto& g = field.geometry();
    const auto axes = rays.lateral();
    return {{},
            interpolation,
            rays,
            {g.period[axes[0]], g.period[axes[1]]},
            std::min(g.spacing(axes[0]), g.spacing(axes[1])),
            strength,
            field.spec().falloff};
}

}  // namespace

DisplacementTables slice_instant(const LatticeField& field, double t, const PathRays& rays, double far, double constant,
                                 double strength, int padding) {
    DisplacementTables instant = blank(field, rays, DepthInterpolation::Linear, strength * constant * far);
    SliceTable slice = slice_table(field, t, rays, kCentroid * far, padding);
    instant.tables.push_back({far, std::move(slice.force), std::nullopt, std::move(slice.index), std::nullopt});
    return instant;
}

DisplacementTables exact_instant(const LatticeField& field, double t, const PathRays& rays,
                                 const std::vector<double>& depths, DepthInterpolation interpolation, double strength,
                                 int padding) {
    DisplacementTables instant = blank(field, rays, interpolation, strength);
    for (PathTable& path : path_tables(field, t, rays, depths, padding)) {
        DisplacementTables::Table table{path.u, std::move(path.displacement), std::nullopt, std::move(path.potential),
                                        std::move(path.potential_slope)};
        if (interpolation == DepthInterpolation::Hermite) table.slope = std::move(path.slope);
        instant.tables.push_back(std::move(table));
    }
    return instant;
}

DisplacementGrid DisplacementTables::grid(const Camera& camera) const {
    DisplacementGrid grid;
    grid.perspective = camera.projection == Projection::Perspective;
    grid.interpolation = interpolation;
    for (const Table& table : tables) grid.depths.push_back(table.depth);
    grid.spacing = node_spacing(cell * camera.f_px / (grid.perspective ? kCentroid * tables.back().depth : 1.0));
    return grid;
}

void DisplacementTables::fill(DisplacementGrid& grid, const Camera& camera) const {
    const auto axes = rays.lateral();
    const auto n = static_cast<std::size_t>(grid.columns);
    std::vector<float> x1, slope;
    for (int r = 0; r < grid.rows; ++r) {
        const double py = (grid.row0 + r) * grid.spacing + 0.5;
        for (std::size_t k = 0; k < tables.size(); ++k) {
            const Table& table = tables[k];
            LineSampler sampler(*this, table_line(camera, grid, py, table.depth), grid.columns);
            sampler.sample(table.displacement, table.potential, x1);
            if (table.slope) sampler.sample(*table.slope, table.potential_slope, slope);
            Node* out = grid.row(r, k);
            for (std::size_t c = 0; c < n; ++c) {
                const StraightRay ray =
                    straight_ray(camera, (grid.column0 + static_cast<int>(c)) * grid.spacing + 0.5, py);
                const double scale = strength * ray.length * ray.length;
                const auto shift = [&](const std::vector<float>& v) {
                    return image_shift(
                        camera, ray, scale * (double{v[2 * c]} * unit(axes[0]) + double{v[2 * c + 1]} * unit(axes[1])));
                };
                const dvec2 x = shift(x1);
                // x1 is linear in u there, so the slope beyond the last depth is that of x1 ∝ u
                const dvec2 s = table.slope ? shift(slope) : x / table.depth;
                out[c] += Node{static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(s.x),
                               static_cast<float>(s.y)};
            }
        }
    }
}

}  // namespace eikonal
