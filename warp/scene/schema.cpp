#include "warp/scene/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "noise/blobs/blobs.h"
#include "noise/medium/refractivity.h"
#include "warp/scene/camera.h"

// names() and keys() are found by the templates of table.h through the types of the scene, hence live in their
// namespace.
namespace eikonal {

using scene_file::any;
using scene_file::at_least;
using scene_file::between;
using scene_file::Entry;
using scene_file::Key;
using scene_file::Names;
using scene_file::positive;
using scene_file::Ranges;
using Keys = std::vector<Key>;

// ---- words of the enumerations -------------------------------------------------------------------------------------

static Names<Projection> names(Projection) {
    static constexpr std::pair<std::string_view, Projection> list[] = {{"perspective", Projection::Perspective},
                                                                       {"orthographic", Projection::Orthographic}};
    return list;
}

static Names<RayEquation> names(RayEquation) {
    static constexpr std::pair<std::string_view, RayEquation> list[] = {{"physical", RayEquation::Physical},
                                                                        {"paper", RayEquation::Paper}};
    return list;
}

static Names<IndexModel> names(IndexModel) {
    static constexpr std::pair<std::string_view, IndexModel> list[] = {{"air", IndexModel::Air},
                                                                       {"paper", IndexModel::Paper}};
    return list;
}

static Names<SpectrumKind> names(SpectrumKind) {
    static constexpr std::pair<std::string_view, SpectrumKind> list[] = {{"von-karman", SpectrumKind::VonKarman},
                                                                         {"paper", SpectrumKind::Paper}};
    return list;
}

static Names<TurbulenceForm> names(TurbulenceForm) {
    static constexpr std::pair<std::string_view, TurbulenceForm> list[] = {
        {"lattice", TurbulenceForm::Lattice},
        {"screens", TurbulenceForm::Screens},
        {"gradient-noise", TurbulenceForm::GradientNoise}};
    return list;
}

static Names<ProfileKind> names(ProfileKind) {
    static constexpr std::pair<std::string_view, ProfileKind> list[] = {{"luneburg", ProfileKind::Luneburg},
                                                                        {"fish-eye", ProfileKind::FishEye},
                                                                        {"linear", ProfileKind::Linear},
                                                                        {"linear-squared", ProfileKind::LinearSquared},
                                                                        {"exponential", ProfileKind::Exponential},
                                                                        {"rod", ProfileKind::Rod},
                                                                        {"sech", ProfileKind::Sech}};
    return list;
}

static Names<ObjectShape> names(ObjectShape) {
    static constexpr std::pair<std::string_view, ObjectShape> list[] = {{"plane", ObjectShape::Plane},
                                                                        {"quad", ObjectShape::Quad},
                                                                        {"sphere", ObjectShape::Sphere},
                                                                        {"mesh", ObjectShape::Mesh}};
    return list;
}

// ---- rules that several tables share -------------------------------------------------------------------------------

static scene_file::Range temperature() {
    return between(kLeastTemperature, kGreatestTemperature);
}

static scene_file::Range within(const BlobKeyRange& allowed) {
    return between(allowed.least, std::min(allowed.most, kLargestValue));
}

/// A vector of which only the direction counts: never zero, normalised.
static Key direction(std::string_view name, std::string_view meaning, dvec3& target) {
    return Key(name, meaning, target).always([&target] {
        const double length = glm::length(target);
        if (!(length >= kSmallestPositive)) return "must not be a zero vector";
        target /= length;
        return "";
    });
}

/// What is wrong with a lattice size, empty if nothing is.
static std::string lattice_size_error(int n) {
    const auto good = [](int size) {
        for (int factor = 2; factor <= scene_file::kLargestFactor; ++factor)
            while (size % factor == 0) size /= factor;
        return size == 1;
    };
    if (n < 2) return fmt::format("size {} is no lattice; must be >= 2", n);
    if (good(n)) return {};
    int below = n, above = n;
    while (!good(below)) --below;
    while (!good(above)) ++above;  // ends at a power of two
    return fmt::format("size {} has a prime factor above {}, for which there is no fast transform; use {} or {}", n,
                       scene_file::kLargestFactor, below, above);
}

// ---- the keys of each table ----------------------------------------------------------------------------------------

static Keys keys(CameraSpec& c) {
    return {
        {"resolution", "width and height in pixels", c.resolution, {between(1, 65536)}},
        {"position", "[m]", c.position},
        Key("look_at", "point in the centre of the picture [m]", c.look_at)
            .otherwise([&c] { c.look_at = c.position + dvec3(0, 0, -1); })
            .always([&c] {
                const bool same = glm::distance(c.look_at, c.position) < kSmallestPositive;
                return same ? "must differ from position" : "";
            }),
        Key("up", "direction that is up in the picture", c.up).always([&c] {
            return view_axes(c.position, c.look_at, c.up) ? "" : "must not be zero or parallel to the view";
        }),
        Key("horizontal_fov", "angle of view [degrees]", c.horizontal_fov, {between(kSmallestFov, kLargestFov)})
            .excludes("focal_length", c.focal_length)
            .excludes("sensor_width", c.sensor_width)
            .only_with("projection", c.projection, {Projection::Perspective}),
        Key("focal_length", "[mm]", c.focal_length, {positive()})
            .only_with("projection", c.projection, {Projection::Perspective}),
        Key("sensor_width", "[mm]", c.sensor_width, {positive()}).given([&c] {
            return c.focal_length ? "" : "needs focal_length";
        }),
        {"projection", "kind of camera", c.projection},
        Key("width", "width of the view [m]", c.width, {positive()})
            .only_with("projection", c.projection, {Projection::Orthographic}),
        {"path", "camera moves, a .chan file", c.path},
    };
}

static Keys keys(TimeSpec& t) {
    return {
        {"fps", "frames a second", t.fps, {between(1e-6, 1e6)}},
        {"first_frame", "the frame at t = 0", t.first_frame, {between(-1e9, 1e9)}},
    };
}

static Keys keys(OpticsSpec& o) {
    return {
        {"ray_equation", "convention of the ray equation", o.ray_equation},
        {"ambient_temperature", "[K]", o.ambient_temperature, {temperature()}},
        {"index", "index of air from its temperature", o.index},
        {"exaggeration", "factor on index minus ambient index", o.exaggeration},
        {"aperture", "diameter of the lens [m]; 0 is a point", o.aperture, {at_least(0)}},
    };
}

static Keys keys(PlateSpec& p) {
    return {
        Key("distance", "of everything in the plate, along the axis [m]", p.distance, {positive()})
            .excludes("ground", p.ground),
        {"far", "distance of the background [m]", p.far, {positive()}},
        {"ground", "height of the camera [m], row of the horizon 0 (top) to 1 (bottom)", p.ground, {positive(), any()}},
    };
}

static Keys keys(Falloff& f) {
    return {
        {"origin", "where strength is 1 [m]", f.origin},
        direction("normal", "away from the heat", f.normal),
        {"length", "over which strength falls by e [m]", f.length, {positive()}},
    };
}

static Keys keys(TurbulenceSpec& t) {
    const auto lattice_error = [&t]() -> std::string {
        for (std::size_t axis = 0; axis < t.lattice->size(); ++axis) {
            const int n = (*t.lattice)[axis];
            if (t.form == TurbulenceForm::Screens && axis == 2 && n >= 1)
                continue;  // screens are not transformed over z
            if (const std::string wrong = lattice_size_error(n); !wrong.empty()) return wrong;
        }
        return {};
    };
    return {
        {"seed", "of its random numbers", t.seed},
        {"spectrum", "spatial spectrum of the index", t.spectrum},
        Key("cn2", "Cn² [m^-2/3]", t.cn2, {at_least(0)}).only_with("spectrum", t.spectrum, {SpectrumKind::VonKarman}),
        Key("outer_scale", "L0, the largest eddies [m]", t.outer_scale, {positive()}).always([&t] {
            const bool ordered = t.outer_scale > t.inner_scale;
            return ordered ? "" : fmt::format("value {}, must be > inner_scale, {}", t.outer_scale, t.inner_scale);
        }),
        {"inner_scale", "l0, the smallest eddies [m]", t.inner_scale, {positive()}},
        Key("strength", "C of S(k) = C k^(-11/3)", t.strength, {at_least(0)})
            .only_with("spectrum", t.spectrum, {SpectrumKind::Paper}),
        Key("lowest_wavenumber", "k_m, cycles per lattice period", t.lowest_wavenumber, {at_least(0)})
            .only_with("spectrum", t.spectrum, {SpectrumKind::Paper}),
        {"alpha", "how fast eddies change [m²/s²]", t.alpha, {at_least(0)}},
        {"velocity", "mean motion [m/s]", t.velocity},
        {"form", "how the turbulence is made", t.form},
        {"falloff", "strength with height above the heat", t.falloff},
        Key("lattice", "sizes nx, ny, nz, nt", t.lattice, {between(0, scene_file::kLargestLattice)})
            .given(lattice_error),
        {"period", "Lx, Ly, Lz [m], T [s]", t.period, {positive()}},
    };
}

static Keys keys(SurfaceSpec& s) {
    return {
        {"origin", "a point of the surface [m]", s.origin},
        direction("normal", "of the surface", s.normal),
        {"surface_temperature", "[K]", s.surface_temperature, {temperature()}},
        {"dropoff", "height over which the heat falls by e [m]", s.dropoff, {positive()}},
    };
}

static Keys keys(BlobSpec& b) {
    return {
        {"center", "[m]", b.center},
        {"sigma", "radius [m]", b.sigma, {within(kBlobSigma)}},
        {"temperature", "[K]", b.temperature, {within(kBlobTemperature)}},
    };
}

static Keys keys(BlobSourceSpec& s) {
    return {
        {"from", "the source, or one end of it [m]", s.from},
        {"to", "its other end, of a line [m]", s.to},
        {"rate", "blobs a second", s.rate, {within(kBlobRate)}},
        {"temperature", "at birth [K]", s.temperature, {within(kBlobTemperature)}},
        {"sigma", "radius [m]", s.sigma, {within(kBlobSigma)}},
        {"cooling", "[1/s]", s.cooling, {at_least(0)}},
        {"growth", "of sigma squared, by diffusion [m²/s]", s.growth, {at_least(0)}},
        Key("lifetime", "of each blob [s]", s.lifetime, {within(kBlobLifetime)}).required(),
    };
}

static Keys keys(WindSpec& w) {
    return {
        {"seed", "of its random numbers", w.seed},
        {"rms", "of each component of the velocity [m/s]", w.rms, {within(kWindSpeed)}},
        {"outer_scale", "largest eddies [m]", w.outer_scale, {within(kWindOuterScale)}},
        {"rise", "mean velocity [m/s]", w.rise, {within(kWindRise)}},
    };
}

static Keys keys(BlobsSpec& b) {
    return {
        {"seed", "of its random numbers", b.seed},
        {"blob", "explicit blobs", b.blobs},
        {"source", "sources of blobs", b.sources},
        {"wind", "that carries the blobs", b.wind},
    };
}

static Keys keys(ProfileSpec& p) {
    using enum ProfileKind;
    return {
        {"profile", "which closed form", p.profile},
        {"center", "[m]", p.center},
        direction("axis", "along which the index changes", p.axis)
            .only_with("profile", p.profile, {Linear, LinearSquared, Exponential, Rod, Sech}),
        Key("radius", "[m]", p.radius, {positive()}).only_with("profile", p.profile, {Luneburg, FishEye}),
        Key("n0", "index at the center", p.n0, {positive()})
            .only_with("profile", p.profile, {FishEye, Linear, LinearSquared, Exponential, Rod, Sech}),
        Key("slope", "per metre", p.slope).only_with("profile", p.profile, {Linear, LinearSquared, Exponential}),
        Key("g", "[1/m]", p.g).only_with("profile", p.profile, {Rod, Sech}),
    };
}

/// A medium's type decides which keys it has.
static void read_value(const Entry& entry, MediumSpec& target, const Ranges&) {
    constexpr std::string_view key = "type", meaning = "kind of medium";
    static const std::pair<std::string_view, MediumSpec> types[] = {{"turbulence", TurbulenceSpec{}},
                                                                    {"surface", SurfaceSpec{}},
                                                                    {"blobs", BlobsSpec{}},
                                                                    {"profile", ProfileSpec{}}};
    std::vector<std::string_view> valid;
    for (const auto& [name, spec] : types) valid.push_back(name);

    const toml::table* table = entry.node.as_table();
    if (!table) fail_value(entry, "must be a table");
    const toml::node* type = table->get(key);
    if (!type) fail(entry, fmt::format("{} is missing; must be \"{}\"", key, fmt::join(valid, "\" or \"")));
    target = types[read_choice(entry.member(key, *type, meaning), valid)].second;

    std::visit(
        [&](auto& spec) {
            Keys list = keys(spec);
            std::string known;  // checked above
            list.emplace_back(key, meaning, known);
            read_table(entry, list);
        },
        target);
}

static Keys keys(ObjectSpec& o) {
    using enum ObjectShape;
    return {
        {"shape", "kind of object", o.shape},
        {"name", "for messages", o.name},
        Key("origin", "a point of the plane, centre of the quad [m]", o.origin)
            .only_with("shape", o.shape, {Plane, Quad}),
        direction("normal", "of the plane or quad", o.normal).only_with("shape", o.shape, {Plane, Quad}),
        Key("up", "direction of the texture's upper side", o.up).only_with("shape", o.shape, {Plane, Quad}).given([&o] {
            const double across = glm::length(glm::cross(*o.up, o.normal));
            return across > kSmallestPositive ? "" : "must not be zero or parallel to normal";
        }),
        Key("size", "width and height [m]", o.size, {positive()}).only_with("shape", o.shape, {Plane, Quad}),
        Key("center", "[m]", o.center).only_with("shape", o.shape, {Sphere, Mesh}),
        Key("radius", "[m]", o.radius, {positive()}).only_with("shape", o.shape, {Sphere}),
        Key("scale", "metres per unit of the file", o.scale, {positive()}).only_with("shape", o.shape, {Mesh}),
        Key("file", "*.obj", o.file).only_with("shape", o.shape, {Mesh}).always([&o] {
            return o.shape == Mesh && !o.file ? "is missing; a mesh needs its *.obj file" : "";
        }),
        {"texture", "a picture", o.texture},
        Key("color", "linear", o.color, {at_least(0)}).excludes("texture", o.texture),
        {"emissive", "shows its colour whatever the light", o.emissive},
        Key("mirror", "part of the light that is reflected", o.mirror, {between(0, 1)})
            .excludes("refractive_index", o.refractive_index),
        {"refractive_index", "of glass", o.refractive_index, {between(0.1, 100)}},
    };
}

static Keys keys(LightSpec& l) {
    return {
        direction("direction", "in which the light travels", l.direction),
        {"color", "linear", l.color, {at_least(0)}},
        {"ambient", "linear", l.ambient, {at_least(0)}},
    };
}

static Keys keys(BackgroundSpec& b) {
    return {
        Key("color", "linear", b.color, {at_least(0)}).excludes("image", b.image),
        {"image", "a latitude-longitude picture", b.image},
    };
}

static Keys keys(Scene& s) {
    const auto profile_alone = [&s] {
        for (const MediumSpec& medium : s.media)
            if (std::holds_alternative<ProfileSpec>(medium) && s.media.size() > 1)
                return "a profile is an absolute index and must be the only medium";
        return "";
    };
    return {
        {"camera", "view", s.camera},
        {"time", "frames and seconds", s.time},
        {"optics", "index of the air", s.optics},
        {"plate", "depth of footage without a depth map", s.plate},
        Key("medium", "hot air", s.media).given(profile_alone),
        {"object", "what the tracer sees", s.objects},
        {"light", "sun", s.light},
        {"background", "behind all objects", s.background},
    };
}

namespace scene_file {

void read_scene(const Entry& root, Scene& scene) {
    read_table(root, keys(scene));
}

}  // namespace scene_file

}  // namespace eikonal
