#include "warp/displace/models/thin_screens.h"

#include <algorithm>
#include <cmath>

#include "noise/base/error.h"
#include "noise/base/instruction_sets.h"
#include "noise/turbulence/lattice/lattice_instant.h"
#include "noise/turbulence/screens/screen_force.h"

namespace eikonal {
namespace {

/// The part of a slab ahead of a camera: its depths along the reference axis [m], and the factor on its bend. The
/// factor is the root of the part.
struct Place {
    double near = 0, far = 0, weight = 0;
    double middle() const { return 0.5 * (near + far); }
};

Place place_of(const ScreenInstant& screen, double advance) {
    const double far = screen.w() + 0.5 * screen.thickness() - advance;
    const double near = std::max(0.0, far - screen.thickness());
    if (far <= near) return {};
    return {near, far, std::sqrt((far - near) / screen.thickness())};
}

/// How far the camera has advanced along the reference axis [m].
double advance_of(const ThinScreens& model, const Camera& camera) {
    return glm::dot(camera.position - model.reference.position, model.reference.forward);
}

bool same_axes(const Camera& a, const Camera& b) {
    return a.right == b.right && a.up == b.up && a.forward == b.forward;
}

/// A screen that a grid is computed from.
struct Active {
    const ScreenInstant* screen;
    Place place;
    ScreenInstant::Columns columns;  ///< the same for every row; used under parallel axes only
};

/// The screens nearer than `farthest` whose nodes are `spacing` apart, nearest first.
std::vector<Active> active_screens(const ThinScreens& model, const Camera& camera, double farthest, int spacing) {
    const double advance = advance_of(model, camera);
    std::vector<Active> active;
    for (const ScreenInstant& screen : model.screens) {
        const Place place = place_of(screen, advance);
        if (place.weight <= 0 || place.near >= farthest) continue;
        const double pixels = camera.f_px / (camera.projection == Projection::Perspective ? place.middle() : 1.0);
        if (node_spacing(screen.cell() * pixels) == spacing) active.push_back({&screen, place, {}});
    }
    return active;
}

/// Where a row of nodes lies on a screen under parallel axes: evenly spaced points on a line [m]. x0 and step are the
/// same for every row.
struct ScreenLine {
    double x0, y0, step;
};

ScreenLine line_on(const ThinScreens& model, const Place& place, const Camera& camera, const DisplacementGrid& grid,
                   double py) {
    const double scale = grid.perspective ? place.middle() : 1.0;
    const dvec2 first = camera.slope(grid.column0 * grid.spacing + 0.5, py);
    const dvec3 moved = camera.position - model.reference.position;
    return {glm::dot(moved, model.reference.right) + scale * first.x,
            glm::dot(moved, model.reference.up) + scale * first.y, scale * grid.spacing / camera.f_px};
}

/// Computes g ∇ψ + ψ ∇g along a row, in place.
void apply_falloff(const ThinScreens& model, const ScreenLine& line, const Place& place, const Camera& camera,
                   const std::vector<float>& values, std::vector<float>& uv) {
    const Camera& reference = model.reference;
    const dvec3 first = reference.position + line.x0 * reference.right + line.y0 * reference.up +
                        (place.middle() + advance_of(model, camera)) * reference.forward;
    const bool level = glm::dot(model.falloff->normal, reference.right) == 0;
    float gain = 0, across_x = 0, across_y = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (i == 0 || !level) {
            const IndexSample g =
                falloff_at(*model.falloff, first + (static_cast<double>(i) * line.step) * reference.right);
            gain = static_cast<float>(g.n);
            across_x = static_cast<float>(glm::dot(g.gradient, reference.right));
            across_y = static_cast<float>(glm::dot(g.gradient, reference.up));
        }
        uv[2 * i] = gain * uv[2 * i] + values[i] * across_x;
        uv[2 * i + 1] = gain * uv[2 * i + 1] + values[i] * across_y;
    }
}

/// factor[i] = f √L³ at slopes (sx + i step, sy).
EIKONAL_CLONES void slant_factors(float sx, float step, float sy, float f, int n, float* factor) {
    const float across = 1 + sy * sy;
    for (int i = 0; i < n; ++i) {
        const float s = sx + static_cast<float>(i) * step;
        const float l = std::sqrt(across + s * s);
        factor[i] = f * l * std::sqrt(l);
    }
}

/// u += s (s·u)/(L + 1) at slopes s = (sx + i step, sy). This is the matrix M of
/// noise/turbulence/screens/screen_force.h. uv: bends along the screen's axes, y up.
EIKONAL_CLONES void slant_bends(float sx, float step, float sy, int n, float* uv) {
    const float across = 1 + sy * sy;
    for (int i = 0; i < n; ++i) {
        const float s = sx + static_cast<float>(i) * step;
        const float along = (s * uv[2 * i] + sy * uv[2 * i + 1]) / (std::sqrt(across + s * s) + 1);
        uv[2 * i] += s * along;
        uv[2 * i + 1] += sy * along;
    }
}

/// nodes[i] += factor[i] (length, slope) × (u, up·v), where up is minus the pixel aspect.
EIKONAL_CLONES void add_bends(const float* uv, const float* factor, float length, float slope, float up, int n,
                              Node* nodes) {
    const Node lever{length, length * up, slope, slope * up};
    for (int i = 0; i < n; ++i) {
        const float f = factor[i];
        const float u = uv[2 * i], v = uv[2 * i + 1];
        nodes[i] += Node{f, f, f, f} * lever * Node{u, v, u, v};
    }
}

/// Computes rows of nodes if the camera's axes are parallel to those of the reference camera.
class AlignedRows {
  public:
    AlignedRows(const ThinScreens& model, DisplacementGrid& grid, const Camera& camera, std::vector<Active>& active)
        : model_(model),
          grid_(grid),
          camera_(camera),
          active_(active),
          uv_(2 * static_cast<std::size_t>(grid.columns)),
          values_(model.falloff ? static_cast<std::size_t>(grid.columns) : 0),
          factor_(static_cast<std::size_t>(grid.columns), static_cast<float>(camera.f_px)) {
        for (Active& a : active_) {
            const ScreenLine line = line_on(model, a.place, camera, grid, 0);
            a.columns = a.screen->columns(line.x0, line.step, grid.columns);
        }
    }

    void fill(int row) {
        const double py = (grid_.row0 + row) * grid_.spacing + 0.5;
        if (grid_.perspective) {
            const dvec2 s = camera_.slope(grid_.column0 * grid_.spacing + 0.5, py);
            slope_x_ = static_cast<float>(s.x);
            slope_y_ = static_cast<float>(s.y);
            slant_factors(slope_x_, slope_step(), slope_y_, static_cast<float>(camera_.f_px), grid_.columns,
                          factor_.data());
        }
        // With a single depth, each screen's bend is weighted by its lever, and the sum of the screens becomes the
        // nodes.
        const bool single = grid_.depths.size() == 1;
        if (single) std::fill(uv_.begin(), uv_.end(), 0.0f);
        for (const Active& a : active_) {
            const double lever = single ? slab_lever(a.place.near, a.place.far, grid_.depths[0]).length : 1.0;
            if (!single) std::fill(uv_.begin(), uv_.end(), 0.0f);
            sample(a, py, lever);
            if (single) continue;
            slant();
            for (std::size_t k = 0; k < grid_.depths.size(); ++k) {
                const SlabLever at = slab_lever(a.place.near, a.place.far, grid_.depths[k]);
                if (at.length > 0) store(row, k, at);
            }
        }
        // Beyond its only depth the displacement in pixels is constant: X ∝ z in perspective.
        if (!single) return;
        slant();
        store(row, 0, {1, grid_.perspective ? 1 / grid_.depths[0] : 0.0});
    }

  private:
    /// Adds a screen's bends times `lever` to uv_.
    void sample(const Active& a, double py, double lever) {
        const ScreenLine line = line_on(model_, a.place, camera_, grid_, py);
        const auto weight = static_cast<float>(model_.strength * a.place.weight * lever);
        if (!model_.falloff) {
            a.screen->add_gradients(a.columns, line.y0, weight, uv_.data());
            return;
        }
        std::vector<float> bend(uv_.size());
        std::fill(values_.begin(), values_.end(), 0.0f);
        a.screen->add_gradients(a.columns, line.y0, weight, bend.data());
        a.screen->add_values(a.columns, line.y0, weight, values_.data());
        apply_falloff(model_, line, a.place, camera_, values_, bend);
        for (std::size_t i = 0; i < uv_.size(); ++i) uv_[i] += bend[i];
    }
    float slope_step() const { return static_cast<float>(grid_.spacing / camera_.f_px); }
    void slant() {
        if (grid_.perspective) slant_bends(slope_x_, slope_step(), slope_y_, grid_.columns, uv_.data());
    }
    void store(int row, std::size_t depth, const SlabLever& lever) {
        add_bends(uv_.data(), factor_.data(), static_cast<float>(lever.length), static_cast<float>(lever.slope),
                  static_cast<float>(-camera_.pixel_aspect), grid_.columns, grid_.row(row, depth));
    }

    const ThinScreens& model_;
    DisplacementGrid& grid_;
    const Camera& camera_;
    std::vector<Active>& active_;
    std::vector<float> uv_, values_, factor_;
    float slope_x_ = 0, slope_y_ = 0;  ///< of the row's first node
};

/// Computes a row of nodes of a camera in any direction, ray by ray.
void fill_turned_row(const ThinScreens& model, DisplacementGrid& grid, const Camera& camera,
                     const std::vector<Active>& active, int row) {
    const Camera& reference = model.reference;
    const double advance = advance_of(model, camera);
    for (int c = 0; c < grid.columns; ++c) {
        const StraightRay ray =
            straight_ray(camera, (grid.column0 + c) * grid.spacing + 0.5, (grid.row0 + row) * grid.spacing + 0.5);
        const double rate = glm::dot(ray.direction, reference.forward);
        if (rate <= 0) continue;  // a ray at the edge of a wide view that does not cross the screens
        const double start = glm::dot(ray.origin - reference.position, reference.forward);
        for (const Active& a : active) {
            // Places are measured from the camera, but an orthographic ray may start elsewhere.
            const double far = (a.place.far + advance - start) / rate;
            const double near = std::max(0.0, (a.place.near + advance - start) / rate);
            if (near >= far || near >= grid.depths.back()) continue;
            const dvec3 p = ray.at(0.5 * (near + far));
            const dvec3 q = p - reference.position;
            const auto s = a.screen->sample(glm::dot(q, reference.right), glm::dot(q, reference.up));
            dvec3 bend = double{s.dx} * reference.right + double{s.dy} * reference.up;
            if (model.falloff) {
                const IndexSample g = falloff_at(*model.falloff, p);
                const dvec3 across = g.gradient - glm::dot(g.gradient, reference.forward) * reference.forward;
                bend = g.n * bend + double{s.value} * across;
            }
            const dvec2 slope(glm::dot(ray.direction, reference.right) / rate,
                              glm::dot(ray.direction, reference.up) / rate);
            const dvec2 slanted =
                slanted_bend(slope, ray.length / rate, {glm::dot(bend, reference.right), glm::dot(bend, reference.up)});
            bend = slanted.x * reference.right + slanted.y * reference.up;
            const double weight = ray.length * std::sqrt((far - near) * ray.length / a.screen->thickness());
            const dvec2 kick = image_shift(camera, ray, (model.strength * weight) * bend);
            for (std::size_t k = 0; k < grid.depths.size(); ++k) {
                const SlabLever lever = slab_lever(near, far, grid.depths[k]);
                grid.row(row, k)[c] +=
                    Node{static_cast<float>(lever.length * kick.x), static_cast<float>(lever.length * kick.y),
                         static_cast<float>(lever.slope * kick.x), static_cast<float>(lever.slope * kick.y)};
            }
        }
    }
}

}  // namespace

std::vector<DisplacementGrid> ThinScreens::grids(const Camera& camera, double nearest, double farthest) const {
    if (glm::dot(camera.forward, reference.forward) < kWidestTurn)
        throw FrameError(
            "the camera has turned more than 60 degrees from the shot's first view, beyond which thin screens do not "
            "hold; "
            "use form=\"lattice\" or form=\"gradient-noise\" for this medium");
    std::vector<DisplacementGrid> result;
    for (int spacing = 1; spacing <= kWidestSpacing; spacing *= 2) {
        const std::vector<Active> active = active_screens(*this, camera, farthest, spacing);
        if (active.empty()) continue;
        DisplacementGrid grid;
        grid.spacing = spacing;
        grid.perspective = camera.projection == Projection::Perspective;
        grid.interpolation = DepthInterpolation::Hermite;
        grid.depths = {nearest, farthest};
        for (const Active& a : active)
            for (const double end : {a.place.near, a.place.far})
                if (end > nearest && end < farthest) grid.depths.push_back(end);
        std::sort(grid.depths.begin(), grid.depths.end());
        grid.depths.erase(std::unique(grid.depths.begin(), grid.depths.end()), grid.depths.end());
        // Behind the last slab X is straight. A grid of one depth would not do: it has no slope.
        const double last = std::max(nearest, active.back().place.far);
        while (same_axes(camera, reference) && grid.perspective && grid.depths.size() > 2 &&
               grid.depths[grid.depths.size() - 2] >= last)
            grid.depths.pop_back();
        result.push_back(std::move(grid));
    }
    return result;
}

void ThinScreens::fill(DisplacementGrid& grid, const Camera& camera) const {
    std::vector<Active> active = active_screens(*this, camera, grid.depths.back(), grid.spacing);
    if (same_axes(camera, reference)) {
        AlignedRows rows(*this, grid, camera, active);
        for (int r = 0; r < grid.rows; ++r) rows.fill(r);
    } else {
        for (int r = 0; r < grid.rows; ++r) fill_turned_row(*this, grid, camera, active, r);
    }
}

}  // namespace eikonal
