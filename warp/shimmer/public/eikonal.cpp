// The public interface (eikonal/eikonal.h), implemented by the internal classes of the library.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "eikonal/eikonal.h"
#include "warp/scene/message.h"
#include "warp/scene/scene.h"
#include "warp/shimmer/footage_shot.h"
#include "warp/shimmer/warp_plate.h"

namespace eikonal {
namespace {

constexpr int kLargestSide = 65535;
/// Number of channels that the resampler processes together.
constexpr int kLanes = 4;

template <class T>
using Names = std::vector<std::pair<std::string_view, T>>;

/// The value that the text of a setting names.
template <class T>
T named(std::string_view setting, std::string_view text, const Names<T>& names) {
    std::vector<std::string_view> valid;
    for (const auto& [name, value] : names) {
        if (name == text) return value;
        valid.push_back(name);
    }
    throw UserError(fmt::format("`{}`: '{}' is none of {}{}", setting, text, fmt::join(valid, "|"),
                                scene_file::did_you_mean(text, valid)));
}

/// UserError unless the condition holds.
void require(bool condition, std::string_view setting, double value, std::string_view allowed) {
    if (!condition) throw UserError(fmt::format("`{}`: {:g} must be {}", setting, value, allowed));
}

bool is_length(double metres) {
    return metres >= kSmallestPositive && metres <= kLargestValue;
}

void check(const Settings& s) {
    const std::string lengths = fmt::format("from {:g} to {:g} m", kSmallestPositive, kLargestValue);
    require(s.width >= 1 && s.width <= kLargestSide, "width", s.width, fmt::format("from 1 to {}", kLargestSide));
    require(s.height >= 1 && s.height <= kLargestSide, "height", s.height, fmt::format("from 1 to {}", kLargestSide));
    require(s.pixel_aspect > 0 && s.pixel_aspect <= kLargestValue, "pixel_aspect", s.pixel_aspect, "more than 0");
    if (s.fps) require(*s.fps > 0 && *s.fps <= kLargestValue, "fps", *s.fps, "more than 0");
    if (s.distance) require(is_length(*s.distance), "distance", *s.distance, lengths);
    if (s.far) require(is_length(*s.far), "far", *s.far, lengths);
    if (s.tolerance) require(*s.tolerance > 0, "tolerance", *s.tolerance, "more than 0");
    if (s.rms) require(*s.rms >= 0 && *s.rms <= kLargestValue, "rms", *s.rms, "0 or more");
    require(s.gain >= 0 && s.gain <= kLargestValue, "gain", s.gain, "0 or more");
    require(s.shutter >= 0 && s.shutter <= 1, "shutter", s.shutter, "from 0 to 1");
    require(s.samples >= 1, "samples", s.samples, "1 or more");
    require(s.dispersion >= 0 && s.dispersion <= kLargestValue, "dispersion", s.dispersion, "0 or more");
    require(s.threads >= 0, "threads", s.threads, "0 or more");
    if ((s.scene.empty() ? 0 : 1) + (s.scene_text.empty() ? 0 : 1) + (s.preset.empty() ? 0 : 1) > 1)
        throw UserError("`scene`, `scene_text` and `preset` contradict each other; give one of them");
    if ((s.distance ? 1 : 0) + (s.ground ? 1 : 0) + (s.depth_map ? 1 : 0) > 1)
        throw UserError("`distance`, `ground` and `depth_map` contradict each other; give one of them");
}

Scene scene_of(const Settings& s) {
    if (!s.scene_text.empty()) return parse_scene(s.scene_text, "scene_text", s.set, s.seed);
    if (!s.scene.empty()) return read_scene(s.scene, s.set, s.seed);
    return read_scene(find_preset(s.preset.empty() ? "gentle" : s.preset), s.set, s.seed);
}

ModelRequest model_of(const std::string& text) {
    if (text.empty()) return {};
    Names<ModelRequest> names;
    for (const auto& [name, model] : kModelNames) names.push_back({name, {false, model}});
    names.push_back({"auto", {true, {}}});
    return named("model", text, names);
}

FootageShotSettings shot_settings(const Settings& s) {
    FootageShotSettings shot;
    shot.view.display = {0, 0, s.width, s.height};
    shot.view.pixel_aspect = s.pixel_aspect;
    shot.view.fps = s.fps;
    shot.view.fov = s.fov;
    shot.depth.distance = s.distance;
    if (s.ground) shot.depth.ground = GroundSettings{(*s.ground)[0], (*s.ground)[1], false};
    shot.depth.given = s.depth_map;
    shot.depth.depth_type = named<DepthType>(
        "depth_type", s.depth_type, {{"z", DepthType::Z}, {"ray", DepthType::Ray}, {"inverse", DepthType::Inverse}});
    shot.depth.far = s.far;
    shot.strength = {s.rms, s.gain, model_of(s.model), s.tolerance};
    shot.state_errors = s.state_errors;
    shot.stop = s.stop;
    return shot;
}

WarpSettings warp_settings(const Settings& s) {
    return {
        named<Filter>("filter", s.filter,
                      {{"bilinear", Filter::Bilinear},
                       {"cubic", Filter::Cubic},
                       {"lanczos3", Filter::Lanczos3},
                       {"area", Filter::Area}}),
        named<Edge>("edge", s.edge,
                    {{"mirror", Edge::Mirror}, {"clamp", Edge::Clamp}, {"wrap", Edge::Wrap}, {"black", Edge::Black}}),
        s.dispersion, s.stop};
}

/// A value as the resampler takes it. NaN counts as 0, and infinity as the largest half, as in files (picture.h).
float finite(float v) {
    constexpr float kLargest = 65504;
    return std::isnan(v) ? 0 : std::isinf(v) ? std::copysign(kLargest, v) : v;
}

/// Copies channels first … first + count - 1 of pixels with `channels` values into lanes.
void load_lanes(std::span<const float> in, std::size_t channels, std::size_t first, std::size_t count,
                LinearImage& lanes) {
    for (std::size_t i = 0; i < lanes.data.area(); ++i)
        for (std::size_t c = 0; c < count; ++c) lanes.pixels[kLanes * i + c] = finite(in[channels * i + first + c]);
}

}  // namespace

struct Shimmer::Shot {
    WarpSettings warp;
    FootageShot footage;
    std::vector<double> offsets;  ///< offsets of the instants within the shutter
    mutable tbb::task_arena arena;

    explicit Shot(const Settings& s)
        : warp(warp_settings(s)),
          footage(scene_of(s), shot_settings(s)),
          offsets(shutter_offsets(s.shutter, s.shutter > 0 ? s.samples : 1)) {}

    static tbb::task_arena arena_of(int threads) {
        return tbb::task_arena(threads > 0 ? threads : tbb::info::default_concurrency());
    }

    const eikonal::Shot& shot() const { return footage.shot(); }

    /// Computes the maps of a frame's instants one after another.
    eikonal::Shot::Maps maps(double frame, const std::vector<double>& instants, const Frame& input,
                             std::vector<Remark>& remarks) const {
        const PixelWindow& window = shot().display();
        const SharedDepth depth = footage.depth().at(static_cast<int>(frame), {nullptr, {}, input.depth}, window,
                                                     window, shot().displacer().camera(frame), remarks);
        return shot().maps(frame, instants, depth, window, {}, remarks, input.progress);
    }
};

Shimmer::Shimmer(const Settings& settings) {
    check(settings);
    tbb::task_arena arena = Shot::arena_of(settings.threads);
    arena.execute([&] { shot_ = std::make_unique<Shot>(settings); });
    shot_->arena.initialize(arena.max_concurrency());
}
Shimmer::~Shimmer() = default;
Shimmer::Shimmer(Shimmer&&) noexcept = default;
Shimmer& Shimmer::operator=(Shimmer&&) noexcept = default;

Map Shimmer::map(double frame, const Frame& input) const {
    return shot_->arena.execute([&] {
        std::vector<Remark> remarks;
        eikonal::Shot::Maps made = shot_->maps(frame, {0}, input, remarks);
        DisplacementMap& map = made.of_instants.front();
        Map result{map.window.width, map.window.height, std::move(map.uv), {}, {}};
        if (made.error)
            result.error = MapError{made.error->samples, made.error->p50, made.error->p95, made.error->largest};
        for (const Remark& remark : remarks)
            if (remark.warning) result.warnings.push_back(remark.text);
        return result;
    });
}

void Shimmer::warp(std::span<const float> in, int channels, std::span<float> out, double frame,
                   const Frame& input) const {
    const PixelWindow& window = shot_->shot().display();
    const std::size_t pixels = window.area(), step = static_cast<std::size_t>(std::max(channels, 0));
    if (channels < 1 || in.size() != pixels * step || out.size() != in.size())
        throw UserError(fmt::format("warp: {} values in and {} out are no pictures of {} x {} pixels of {} channels",
                                    in.size(), out.size(), window.width, window.height, channels));
    shot_->arena.execute([&] {
        std::vector<Remark> remarks;
        const std::vector<DisplacementMap> maps = shot_->maps(frame, shot_->offsets, input, remarks).of_instants;
        const std::vector<std::uint8_t> moved = moved_pixels(maps, window);
        LinearImage lanes{window, window, 1, std::vector<float>(kLanes * pixels, 0.0F)}, result;
        std::copy(in.begin(), in.end(), out.begin());
        for (std::size_t first = 0; first < step; first += kLanes) {
            const std::size_t count = std::min<std::size_t>(kLanes, step - first);
            load_lanes(in, step, first, count, lanes);
            warp_lanes(lanes, maps, shot_->warp, step == 3 || step == 4, result);
            for (std::size_t i = 0; i < pixels; ++i)
                if (moved[i] != 0) std::copy_n(&result.pixels[kLanes * i], count, &out[step * i + first]);
        }
    });
}

Expected Shimmer::expected() const {
    return shot_->arena.execute([&] {
        return Expected{shot_->shot().expected_rms(), shot_->shot().focusing_variance()};
    });
}
std::vector<std::string> Shimmer::models() const {
    return shot_->shot().displacer().models();
}
double Shimmer::gain() const {
    return shot_->shot().gain();
}
std::vector<std::string> Shimmer::notes() const {
    return shot_->arena.execute([&] { return shot_->footage.notes(); });
}
std::vector<std::string> Shimmer::warnings() const {
    return shot_->arena.execute([&] { return shot_->shot().warnings({}); });
}

std::vector<std::string> preset_names() {
    std::vector<std::string> names;
    for (const Preset& preset : list_presets()) names.push_back(preset.name);
    return names;
}

std::string version() {
    return EIKONAL_VERSION;
}

}  // namespace eikonal
