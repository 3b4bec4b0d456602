#include "warp/scene/schema.h"

#include <glm/geometric.hpp>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "noise/medium/keys.h"
#include "noise/medium/medium_kinds.h"
#include "noise/medium/medium_spec.h"
#include "warp/scene/camera.h"

namespace eikonal {

// ---- words of the enumerations -------------------------------------------------------------------------------------

static EnumNames<Projection> names(Projection) {
    static constexpr std::pair<std::string_view, Projection> list[] = {{"perspective", Projection::Perspective},
                                                                       {"orthographic", Projection::Orthographic}};
    return list;
}

static EnumNames<ObjectShape> names(ObjectShape) {
    static constexpr std::pair<std::string_view, ObjectShape> list[] = {{"plane", ObjectShape::Plane},
                                                                        {"quad", ObjectShape::Quad},
                                                                        {"sphere", ObjectShape::Sphere},
                                                                        {"mesh", ObjectShape::Mesh}};
    return list;
}

// ---- the keys of each table ----------------------------------------------------------------------------------------

static Keys keys(CameraSpec& c) {
    return {
        {"resolution", "width and height in pixels", c.resolution, {between(1, 65536)}},
        {"position", "", "m", c.position},
        Key("look_at", "point in the centre of the picture", "m", c.look_at)
            .otherwise([&c] { c.look_at = c.position + dvec3(0, 0, -1); })
            .always([&c] {
                const bool same = glm::distance(c.look_at, c.position) < kSmallestPositive;
                return same ? "must differ from position" : "";
            }),
        Key("up", "direction that is up in the picture", c.up).always([&c] {
            return view_axes(c.position, c.look_at, c.up) ? "" : "must not be zero or parallel to the view";
        }),
        Key("horizontal_fov", "angle of view", "degrees", c.horizontal_fov, {between(kSmallestFov, kLargestFov)})
            .excludes("focal_length", c.focal_length)
            .excludes("sensor_width", c.sensor_width)
            .only_with("projection", c.projection, {Projection::Perspective}),
        Key("focal_length", "", "mm", c.focal_length, {positive()})
            .only_with("projection", c.projection, {Projection::Perspective}),
        Key("sensor_width", "", "mm", c.sensor_width, {positive()}).given([&c] {
            return c.focal_length ? "" : "needs focal_length";
        }),
        {"projection", "kind of camera", c.projection},
        Key("width", "width of the view", "m", c.width, {positive()})
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

static Keys keys(PlateSpec& p) {
    return {
        Key("distance", "of everything in the plate, along the axis", "m", p.distance, {positive()})
            .excludes("ground", p.ground),
        {"far", "distance of the background", "m", p.far, {positive()}},
        {"ground",
         Quantities{{"height of the camera", "m"}, {"row of the horizon 0 (top) to 1 (bottom)", ""}},
         p.ground,
         {positive(), any()}},
    };
}

// ---- media: the key `type` decides which other keys there are ----

static constexpr std::string_view kType = "type", kTypeMeaning = "kind of medium";

static std::vector<std::string_view> medium_types() {
    std::vector<std::string_view> types;
    for (const MediumKind& kind : medium_kinds()) types.push_back(kind.type);
    return types;
}

/// The key `type` of a medium whose kind is known. Its value can be shown; it does not need to be read again.
class TypeTarget final : public KeyTarget {
  public:
    explicit TypeTarget(std::string_view type) : type_(type) {}

    void read(KeyReader&, const Ranges&) const override {}
    ValueKind kind() const override { return ValueKind::Choice; }
    std::string text() const override { return std::string(type_); }
    std::vector<std::string_view> words() const override { return medium_types(); }

  private:
    std::string_view type_;
};

static Keys keys(MediumSpec& medium) {
    Keys list = medium.keys();
    list.emplace_back(kType, Quantities{{kTypeMeaning, ""}}, std::make_shared<TypeTarget>(medium.type()));
    return list;
}

static void read_value(KeyReader& reader, std::vector<MediumSpec>& target, const Ranges&) {
    target.clear();
    reader.read_tables([&](KeyReader& one) {
        target.push_back(medium_kinds()[one.read_kind(kType, kTypeMeaning, medium_types())].defaults());
        one.read_table(keys(target.back()));
    });
}

// ---- what the tracer sees ----

static Keys keys(ObjectSpec& o) {
    using enum ObjectShape;
    return {
        {"shape", "kind of object", o.shape},
        {"name", "for messages", o.name},
        Key("origin", "a point of the plane, centre of the quad", "m", o.origin)
            .only_with("shape", o.shape, {Plane, Quad}),
        direction_key("normal", "of the plane or quad", o.normal).only_with("shape", o.shape, {Plane, Quad}),
        Key("up", "direction of the texture's upper side", o.up).only_with("shape", o.shape, {Plane, Quad}).given([&o] {
            const double across = glm::length(glm::cross(*o.up, o.normal));
            return across > kSmallestPositive ? "" : "must not be zero or parallel to normal";
        }),
        Key("size", "width and height", "m", o.size, {positive()}).only_with("shape", o.shape, {Plane, Quad}),
        Key("center", "", "m", o.center).only_with("shape", o.shape, {Sphere, Mesh}),
        Key("radius", "", "m", o.radius, {positive()}).only_with("shape", o.shape, {Sphere}),
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
        direction_key("direction", "in which the light travels", l.direction),
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

Keys keys(Scene& s) {
    const auto absolute_alone = [&s]() -> std::string {
        for (const MediumSpec& medium : s.media)
            if (medium.has_absolute_index() && s.media.size() > 1)
                return "a " + std::string(medium.type()) + " is an absolute index and must be the only medium";
        return {};
    };
    return {
        {"camera", "view", s.camera},
        {"time", "frames and seconds", s.time},
        {"optics", "index of the air", s.optics},
        {"plate", "depth of footage without a depth map", s.plate},
        Key("medium", "hot air", s.media).given(absolute_alone),
        {"object", "what the tracer sees", s.objects},
        {"light", "sun", s.light},
        {"background", "behind all objects", s.background},
    };
}

}  // namespace eikonal
