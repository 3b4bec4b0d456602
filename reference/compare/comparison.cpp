#include "reference/compare/comparison.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>

#include "noise/base/error.h"
#include "reference/compare/resident_memory.h"
#include "warp/pixels/depth_range.h"
#include "warp/resample/resample.h"
#include "warp/scene/message.h"
#include "warp/shimmer/depth_input.h"
#include "warp/shimmer/shot.h"

namespace eikonal::reference {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double length(double x, double y) {
    return std::sqrt(x * x + y * y);
}

bool answered(const RenderedFrame& truth, std::size_t i) {
    return truth.id[i] >= 0;
}

Background warp_background(const Scene& scene) {
    return background_of(scene, {KnownDepth::Kind::Map, {}, {}, {}});
}

ShotSettings shot_settings(const Scene& scene, std::optional<Model> model, const std::stop_token& stop) {
    ShotSettings settings;
    const auto [width, height] = scene.camera.resolution.value_or(kDefaultResolution);
    settings.view.display = {0, 0, width, height};
    settings.background = warp_background(scene);
    settings.strength.model.model = model;
    settings.state_errors = true;
    settings.stop = stop;
    return settings;
}

/// Depth as the warp would read it from the plate's channel Z.
DepthPlane depth_plane(const RenderedFrame& plate, const PixelWindow& window, const Background& background) {
    std::vector<float> metres = plate.depth;
    for (float& z : metres) z = z < kInfiniteDepth ? std::max(z, kNearestDepth) : static_cast<float>(background.far);
    if (background.mirage) put_background_behind(metres, background.far);
    return {window, std::move(metres)};
}

/// One flag a pixel: whether it is near a silhouette.
std::vector<std::uint8_t> near_silhouettes(const RenderedFrame& plate, const RenderedFrame& truth,
                                           Projection projection) {
    const std::vector<int> distance = silhouette_distance(plate.depth, plate.width, plate.height, projection);
    std::vector<std::uint8_t> near(distance.size());
    for (std::size_t i = 0; i < near.size(); ++i)
        near[i] = distance[i] <= std::max<double>(kSilhouetteReach, length(truth.u[i], truth.v[i])) ? 1 : 0;
    return near;
}

RenderSettings render_settings(const CompareSettings& settings, bool straight, bool colour) {
    RenderSettings render;
    render.samples = settings.samples;
    render.straight = straight;
    render.colour = colour;
    render.stop = settings.stop;
    if (straight) return render;
    render.rays = settings.rays;
    render.magnification = colour && follows_bundles(settings.rays.integrator);
    return render;
}

void map(const eikonal::Shot& shot, int frame, const SharedDepth& depth, ModelFrame& into) {
    const PixelWindow& window = std::get<DepthPlane>(depth).window();
    into.uv.resize(2 * window.area());
    shot.map(frame, depth, window, into.uv.data());
}

/// A row of the table, and what its figures are computed from.
struct Contender {
    ModelResult result;
    std::optional<Model> model;           ///< the model asked for
    std::unique_ptr<eikonal::Shot> shot;  ///< null for the plate itself, and for a model that does not apply
    std::vector<float> smooth, silhouettes, temporal;
    std::vector<double> map_seconds, warp_seconds, stated;
    std::vector<PictureError> pictures;

    /// Computes uv and warped of a frame, and measures the time.
    void answer(int frame, const SharedDepth& depth, const std::vector<float>& plate, ModelFrame& into) {
        const PixelWindow& window = std::get<DepthPlane>(depth).window();
        into.uv.assign(2 * window.area(), 0);
        into.warped = plate;
        if (!shot) return;
        std::vector<double> maps, warps;
        const auto begin = Clock::now();
        while (maps.size() < kTimedRuns && (maps.empty() || seconds_since(begin) < kTimingSeconds)) {
            auto start = Clock::now();
            map(*shot, frame, depth, into);
            maps.push_back(seconds_since(start));
            start = Clock::now();
            const std::ptrdiff_t stride = 4 * static_cast<std::ptrdiff_t>(window.width);
            resample({plate.data(), window, 4, stride}, {into.uv.data(), window, stride / 2},
                     {into.warped.data(), window, 4, stride}, {});
            warps.push_back(seconds_since(start));
        }
        stated.push_back(shot->stated_error(frame, depth, window, into.uv.data()).p95);
        map_seconds.push_back(median(std::move(maps)));
        warp_seconds.push_back(median(std::move(warps)));
    }
    void judge(const RenderedFrame& truth, const std::vector<std::uint8_t>& edges, ModelFrame& answer) {
        answer.error.assign(truth.id.size(), -1);
        for (std::size_t i = 0; i < truth.id.size(); ++i) {
            if (!answered(truth, i)) continue;
            const double dx = double{answer.uv[2 * i]} - truth.u[i], dy = double{answer.uv[2 * i + 1]} - truth.v[i];
            answer.error[i] = static_cast<float>(length(dx, dy));
            (edges[i] != 0 ? silhouettes : smooth).push_back(answer.error[i]);
        }
        pictures.push_back(picture_error(truth.color, answer.warped, truth.width, truth.height));
    }
    /// Compares the change of displacement from one frame to the next with the true change.
    void judge_change(const RenderedFrame& truth_before, const RenderedFrame& truth, const ModelFrame& before,
                      ModelFrame& now) {
        now.change.assign(truth.id.size(), -1);
        for (std::size_t i = 0; i < truth.id.size(); ++i) {
            if (!answered(truth, i) || !answered(truth_before, i)) continue;
            const auto change = [&](std::size_t axis, const std::vector<float>& t0, const std::vector<float>& t1) {
                return (double{now.uv[2 * i + axis]} - before.uv[2 * i + axis]) - (double{t1[i]} - t0[i]);
            };
            now.change[i] =
                static_cast<float>(length(change(0, truth_before.u, truth.u), change(1, truth_before.v, truth.v)));
            temporal.push_back(now.change[i]);
        }
    }
    ModelResult summary() const {
        ModelResult r = result;
        if (!r.applies()) return r;
        std::vector<float> all = smooth;
        all.insert(all.end(), silhouettes.begin(), silhouettes.end());
        r.all = error_statistics(std::move(all));
        r.smooth = error_statistics(smooth);
        r.silhouettes = error_statistics(silhouettes);
        r.temporal = error_statistics(temporal);
        for (const PictureError& p : pictures) {
            const auto count = static_cast<double>(pictures.size());
            r.picture.psnr += p.psnr / count;
            r.picture.ssim += p.ssim / count;
            r.picture.butteraugli += p.butteraugli / count;
        }
        if (!map_seconds.empty()) {
            r.map_seconds = median(map_seconds);
            r.warp_seconds = median(warp_seconds);
            r.stated_p95 = median(stated);
        }
        return r;
    }
};

void check_names(const std::vector<std::string>& models) {
    std::vector<std::string_view> known{kDefaultModel};
    for (const auto& [name, model] : kModelNames) known.push_back(name);
    for (const std::string& name : models)
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw UserError(fmt::format("`models`: '{}' is none of {}{}", name, fmt::join(known, "|"),
                                        scene_file::did_you_mean(name, known)));
}

Contender contender(std::string_view name) {
    Contender c;
    c.result.name = name;
    return c;
}

/// The rows of the table: the plate itself, each model, and the default if it is none of these.
std::vector<Contender> contenders(const Scene& scene, const CompareSettings& settings) {
    const std::vector<std::string>& wanted = settings.models;
    const auto is_wanted = [&](std::string_view name) {
        return wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
    };
    const std::vector<std::string> usual =
        eikonal::Shot(scene, shot_settings(scene, {}, settings.stop)).displacer().models();
    std::vector<Contender> list;
    list.push_back(contender(kNoModel));
    const auto settle = [&](Contender& c, std::optional<Model> model) {
        const auto start = Clock::now();
        c.model = model;
        c.shot = std::make_unique<eikonal::Shot>(scene, shot_settings(scene, model, settings.stop));
        c.result.setup_seconds = seconds_since(start);
    };
    bool has_default = false;
    for (const auto& [name, model] : kModelNames) {
        if (!is_wanted(name)) continue;
        Contender c = contender(name);
        try {
            settle(c, model);
            if (usual.empty())
                c.result.refusal = c.shot->displacer().mirages()
                                       ? "no medium of this scene takes a model: surfaces bend rays exactly"
                                       : "nothing in this scene moves pixels";
            else if (c.shot->displacer().models() == usual &&
                     std::count(usual.begin(), usual.end(), name) != static_cast<std::ptrdiff_t>(usual.size()))
                c.result.refusal = fmt::format("the same as default, which takes {}", fmt::join(usual, ", "));
            else if (c.shot->displacer().models() == usual)
                c.result.is_default = has_default = true;
        } catch (const UserError& refusal) {
            c.result.refusal = refusal.what();
        }
        if (!c.result.applies()) c.shot.reset();
        list.push_back(std::move(c));
    }
    if (is_wanted(kDefaultModel) && !has_default) {
        Contender c = contender(kDefaultModel);
        c.result.is_default = true;
        settle(c, {});
        list.push_back(std::move(c));
    }
    if (std::none_of(list.begin(), list.end(), [](const Contender& c) { return c.shot != nullptr; }))
        throw UserError(list.back().result.refusal);
    return list;
}

}  // namespace

struct Comparer::Shot {
    Scene scene;
    CompareSettings settings;
    Background sky;  ///< the same as in the warp
    std::vector<Contender> contenders;
    Renderer plate, centers, picture;
    std::vector<Frame> frames;  ///< the last one added and, if there is one, the one before it
    std::vector<int> numbers;
    std::vector<double> tracer_seconds, picture_seconds;
    double pixels = 0, edges = 0, background = 0, answers = 0, squares = 0, largest = 0, estimated = 0;
    double folded = 0, trapped = 0, without_index = 0;

    Shot(const Scene& s, const CompareSettings& set)
        : scene(s),
          settings(set),
          sky(warp_background(s)),
          contenders(reference::contenders(scene, set)),
          plate(scene, render_settings(set, true, true)),
          centers(scene, render_settings(set, false, false)),
          picture(scene, render_settings(set, false, true)) {}
    Shot(const Shot&) = delete;  // renderers and displacers refer to the scene

    void note(const RenderedFrame& truth, const std::vector<std::uint8_t>& edge) {
        numbers.push_back(frames.back().number);
        pixels += static_cast<double>(truth.id.size());
        edges += static_cast<double>(std::count(edge.begin(), edge.end(), 1));
        const std::vector<float>& depth = frames.back().plate.depth;
        background += static_cast<double>(
            std::count_if(depth.begin(), depth.end(), [](float z) { return !(z < kInfiniteDepth); }));
        folded += static_cast<double>(truth.folded());
        trapped += static_cast<double>(truth.trapped());
        without_index += static_cast<double>(truth.without_index());
        for (std::size_t i = 0; i < truth.id.size(); ++i) {
            if (!answered(truth, i)) continue;
            const double d = length(truth.u[i], truth.v[i]);
            squares += d * d;
            largest = std::max(largest, d);
            estimated += double{truth.error[i]};
            ++answers;
        }
    }
};

Comparer::Comparer(const Scene& scene, const CompareSettings& settings) {
    check_names(settings.models);
    shot_ = std::make_unique<Shot>(scene, settings);
}
Comparer::~Comparer() = default;

int Comparer::tile_count() const {
    return 3 * shot_->plate.tile_count();
}

const Comparer::Frame& Comparer::add(int number, const std::function<void()>& tile_done) {
    Shot& s = *shot_;
    Frame frame;
    frame.number = number;
    frame.plate = s.plate.render(number, tile_done);
    const PixelWindow window{0, 0, frame.plate.width, frame.plate.height};
    const SharedDepth depth = depth_plane(frame.plate, window, s.sky);
    auto start = Clock::now();
    frame.truth = s.centers.render(number, tile_done, s.sky.behind(range_of(depth).farthest));
    s.tracer_seconds.push_back(seconds_since(start));
    start = Clock::now();
    RenderedFrame coloured = s.picture.render(number, tile_done);
    s.picture_seconds.push_back(seconds_since(start));
    frame.truth.color = std::move(coloured.color);
    frame.truth.magnification = std::move(coloured.magnification);

    const std::vector<std::uint8_t> edges = near_silhouettes(frame.plate, frame.truth, s.scene.camera.projection);
    const Frame* before = s.frames.empty() ? nullptr : &s.frames.back();
    frame.models.resize(s.contenders.size());
    for (std::size_t m = 0; m < s.contenders.size(); ++m) {
        Contender& c = s.contenders[m];
        ModelFrame& answer = frame.models[m];
        if (!c.result.applies()) continue;
        if (before == nullptr && c.shot) {
            const MemoryWatch memory;
            map(eikonal::Shot(s.scene, shot_settings(s.scene, c.model, s.settings.stop)), number, depth, answer);
            c.result.memory = memory.most_grown();
        }
        c.answer(number, depth, frame.plate.color, answer);
        c.judge(frame.truth, edges, answer);
        if (before != nullptr) c.judge_change(before->truth, frame.truth, before->models[m], answer);
    }
    if (s.frames.size() == 2) s.frames.erase(s.frames.begin());
    s.frames.push_back(std::move(frame));
    s.note(s.frames.back().truth, edges);
    return s.frames.back();
}

Comparison Comparer::result() const {
    const Shot& s = *shot_;
    Comparison c;
    c.scene = s.scene.file.filename().string();
    c.width = s.frames.back().plate.width;
    c.height = s.frames.back().plate.height;
    c.samples = s.settings.samples;
    c.frames = s.numbers;
    c.integrator = name_of(s.settings.rays.integrator);
    c.tolerance = s.settings.rays.tolerance_px;
    c.tracer_seconds = median(s.tracer_seconds);
    c.picture_seconds = median(s.picture_seconds);
    c.tracer_error = s.answers > 0 ? s.estimated / s.answers : 0;
    c.rms = s.answers > 0 ? std::sqrt(s.squares / s.answers) : 0;
    c.largest = s.largest;
    c.far = s.sky.far;
    c.silhouettes = s.edges / s.pixels;
    c.background = s.background / s.pixels;
    if (follows_bundles(s.settings.rays.integrator)) c.folded = s.folded / s.pixels;
    c.trapped = s.trapped / s.pixels;
    c.without_index = s.without_index / s.pixels;
    for (const Contender& contender : s.contenders) {
        if (contender.shot && c.focusing_variance == 0) c.focusing_variance = contender.shot->focusing_variance();
        c.models.push_back(contender.summary());
    }
    return c;
}

}  // namespace eikonal::reference
