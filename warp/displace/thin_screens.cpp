#include "warp/displace/thin_screens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "noise/error.h"
#include "noise/lattice_snapshot.h"

namespace eikonal {
namespace {


/// Where a screen acts, seen from a camera: depth along the reference axis ahead of the camera, and the root of the part
/// of the slab that lies ahead.
struct Place {
    double depth = 0, weight = 0;
};

Place place_of(const ScreenSnapshot& screen, double camera_offset) {
    const double front = screen.w() + 0.5 * screen.thickness() - camera_offset;
    if (front <= 0) return {};
    const double back = std::max(0.0, front - screen.thickness());
    return {0.5 * (front + back), std::sqrt((front - back) / screen.thickness())};
}

double camera_offset(const ScreensInstant& model, const Camera& camera) {
    return glm::dot(camera.position - model.reference.position, model.reference.forward);
}

int spacing_of(const ScreenSnapshot& screen, const Camera& camera, double depth) {
    return node_spacing(screen.cell() * camera.f_px / (camera.projection == Projection::Perspective ? depth : 1.0));
}

/// A screen of the band, ready to be added row by row.
struct Active {
    const ScreenSnapshot* screen;
    Place place;
};

/// X(z) = Σ (z - z_m) a_m over the screens ahead of z: running sums of a and a z_m, taken layer by layer.
class Accumulator {
  public:
    Accumulator(Band& band, int row) : band_(band), row_(row), sums_(static_cast<std::size_t>(band.columns)) {}

    /// kick: image-space slope f L a of one screen at `column`, acting from depth z.
    void add(int column, double z, float kick_x, float kick_y) {
        const auto zf = static_cast<float>(z);
        sums_[static_cast<std::size_t>(column)] += Node{kick_x * zf, kick_y * zf, kick_x, kick_y};
    }
    void store(std::size_t layer) {
        const auto z = static_cast<float>(band_.depths[layer]);
        Node* out = band_.row(row_, layer);
        for (std::size_t c = 0; c < sums_.size(); ++c) {
            const Node s = sums_[c];
            out[c] += Node{z * s[2] - s[0], z * s[3] - s[1], s[2], s[3]};
        }
    }

  private:
    Band& band_;
    int row_;
    std::vector<Node> sums_;
};

/// One row of screen samples under parallel axes: a straight, evenly spaced line on the screen.
void add_aligned(const ScreensInstant& model, const Active& active, const Camera& camera, const Band& band, double py,
                 std::vector<float>& uv, std::vector<float>& values) {
    const bool perspective = band.perspective;
    const double scale = perspective ? active.place.depth : 1.0;
    const dvec2 first = camera.slope(band.column0 * band.spacing + 0.5, py);
    const dvec3 moved = camera.position - model.reference.position;
    const double x0 = glm::dot(moved, model.reference.right) + scale * first.x;
    const double y0 = glm::dot(moved, model.reference.up) + scale * first.y;
    const double step = scale * band.spacing / camera.f_px;
    const auto n = static_cast<std::size_t>(band.columns);
    const auto weight = static_cast<float>(model.strength * active.place.weight);
    std::fill(uv.begin(), uv.end(), 0.0f);
    active.screen->add_gradients(x0, y0, step, 0, band.columns, weight, uv.data());
    if (!model.falloff) return;
    std::fill(values.begin(), values.end(), 0.0f);
    active.screen->add_values(x0, y0, step, 0, band.columns, weight, values.data());
    const dvec3 base = camera.position + active.place.depth * camera.forward;
    for (std::size_t i = 0; i < n; ++i) {
        const dvec3 p = base + scale * ((first.x + static_cast<double>(i) * band.spacing / camera.f_px) * camera.right +
                                        first.y * camera.up);
        const IndexSample g = falloff_at(*model.falloff, p);
        const auto gain = static_cast<float>(g.n);
        uv[2 * i] = gain * uv[2 * i] + values[i] * static_cast<float>(glm::dot(g.gradient, model.reference.right));
        uv[2 * i + 1] = gain * uv[2 * i + 1] + values[i] * static_cast<float>(glm::dot(g.gradient, model.reference.up));
    }
}

bool same_axes(const Camera& a, const Camera& b) {
    return a.right == b.right && a.up == b.up && a.forward == b.forward;
}

void fill_aligned_row(const ScreensInstant& model, Band& band, const Camera& camera, const std::vector<Active>& active,
                      int row) {
    const double py = (band.row0 + row) * band.spacing + 0.5;
    const auto n = static_cast<std::size_t>(band.columns);
    std::vector<float> uv(2 * n), values(model.falloff ? n : 0);
    std::vector<float> kick_x(n);  // f L of each column
    const double sy = camera.slope(0.5, py).y;
    for (std::size_t c = 0; c < n; ++c) {
        const double sx = camera.slope((band.column0 + static_cast<int>(c)) * band.spacing + 0.5, py).x;
        kick_x[c] = static_cast<float>(camera.f_px * (band.perspective ? std::sqrt(1 + sx * sx + sy * sy) : 1.0));
    }
    const auto aspect = static_cast<float>(-camera.pixel_aspect);
    Accumulator sums(band, row);
    std::size_t next = 0;
    for (std::size_t layer = 0; layer < band.depths.size(); ++layer) {
        for (; next < active.size() && active[next].place.depth <= band.depths[layer]; ++next) {
            add_aligned(model, active[next], camera, band, py, uv, values);
            for (std::size_t c = 0; c < n; ++c)
                sums.add(static_cast<int>(c), active[next].place.depth, kick_x[c] * uv[2 * c],
                         kick_x[c] * aspect * uv[2 * c + 1]);
        }
        sums.store(layer);
    }
}

void fill_turned_row(const ScreensInstant& model, Band& band, const Camera& camera, const std::vector<Active>& active,
                     int row) {
    const Camera& reference = model.reference;
    for (int c = 0; c < band.columns; ++c) {
        const StraightRay ray = straight_ray(camera, (band.column0 + c) * band.spacing + 0.5,
                                             (band.row0 + row) * band.spacing + 0.5);
        const double advance = glm::dot(ray.direction, reference.forward);
        if (advance <= 0) continue;  // a ray at the very edge of a wide view that never meets the screens
        const double start = glm::dot(ray.origin - reference.position, reference.forward);
        for (const Active& a : active) {
            // active depths are measured from the camera; an orthographic ray may start elsewhere
            const double plane = a.place.depth + glm::dot(camera.position - reference.position, reference.forward);
            const double z = (plane - start) / advance;
            if (z <= 0) continue;
            const dvec3 p = ray.at(z);
            const dvec3 q = p - reference.position;
            const auto s = a.screen->sample(glm::dot(q, reference.right), glm::dot(q, reference.up));
            dvec3 bend = double{s.dx} * reference.right + double{s.dy} * reference.up;
            if (model.falloff) {
                const IndexSample g = falloff_at(*model.falloff, p);
                const dvec3 across = g.gradient - glm::dot(g.gradient, reference.forward) * reference.forward;
                bend = g.n * bend + double{s.value} * across;
            }
            const dvec2 kick = image_shift(camera, ray, (model.strength * a.place.weight * ray.length) * bend);
            for (std::size_t layer = 0; layer < band.depths.size(); ++layer) {
                const double reach = band.depths[layer] - z;
                if (reach <= 0) continue;
                band.row(row, layer)[c] += Node{static_cast<float>(reach * kick.x), static_cast<float>(reach * kick.y),
                                                static_cast<float>(kick.x), static_cast<float>(kick.y)};
            }
        }
    }
}

}  // namespace

std::vector<Band> ScreensInstant::bands(const Camera& camera, double nearest, double farthest) const {
    if (glm::dot(camera.forward, reference.forward) < kWidestTurn)
        throw FrameError("the camera has turned more than 60 degrees from the shot's first view, beyond which thin screens do not hold; "
                         "use form=\"lattice\" or form=\"gradient-noise\" for this medium");
    const double offset = camera_offset(*this, camera);
    std::vector<Band> result;
    for (int spacing = 1; spacing <= kWidestSpacing; spacing *= 2) {
        Band band;
        band.spacing = spacing;
        band.perspective = camera.projection == Projection::Perspective;
        band.interpolation = DepthInterpolation::Linear;
        bool any = false;
        band.depths.push_back(nearest);
        for (const ScreenSnapshot& screen : screens) {
            const Place place = place_of(screen, offset);
            if (place.weight <= 0 || place.depth >= farthest || spacing_of(screen, camera, place.depth) != spacing) continue;
            any = true;
            if (place.depth > nearest) band.depths.push_back(place.depth);
        }
        if (farthest > nearest) band.depths.push_back(farthest);
        if (any) result.push_back(std::move(band));
    }
    return result;
}

void ScreensInstant::fill(Band& band, const Camera& camera) const {
    const double offset = camera_offset(*this, camera);
    std::vector<Active> active;
    for (const ScreenSnapshot& screen : screens) {
        const Place place = place_of(screen, offset);
        if (place.weight > 0 && place.depth < band.depths.back() && spacing_of(screen, camera, place.depth) == band.spacing)
            active.push_back({&screen, place});
    }
    std::stable_sort(active.begin(), active.end(),
                     [](const Active& a, const Active& b) { return a.place.depth < b.place.depth; });
    const bool aligned = same_axes(camera, reference);
    for (int r = 0; r < band.rows; ++r) {
        if (aligned)
            fill_aligned_row(*this, band, camera, active, r);
        else
            fill_turned_row(*this, band, camera, active, r);
    }
}

}  // namespace eikonal
