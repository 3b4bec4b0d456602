#include "warp/shimmer/warp_plate.h"

#include <algorithm>
#include <stdexcept>

#include "noise/medium/refractivity.h"
#include "warp/displace/grid/model.h"
#include "warp/pixels/rows.h"

namespace eikonal {
namespace {

PixelWindow unite(const PixelWindow& a, const PixelWindow& b) {
    const int x0 = std::min(a.x0, b.x0), y0 = std::min(a.y0, b.y0);
    return {x0, y0, std::max(a.x0 + a.width, b.x0 + b.width) - x0, std::max(a.y0 + a.height, b.y0 + b.height) - y0};
}

/// The part of a map that lies on `window`, which it must cover.
MapView view_of(const DisplacementMap& map, const PixelWindow& window) {
    const auto stride = 2 * static_cast<std::ptrdiff_t>(map.window.width);
    const float* first = map.uv.data() + (window.y0 - map.window.y0) * stride + 2 * (window.x0 - map.window.x0);
    return {first, window, stride};
}

/// Buffers of tens of megabytes. A thread keeps them from frame to frame, since fresh pages would have to be cleared.
struct Workspace {
    LinearImage in, out;
    std::vector<float> instant;
};

Workspace& workspace() {
    static thread_local Workspace space;
    return space;
}

/// Resamples with the first map, then adds the others.
void add_up(const LinearImage& in, const std::vector<DisplacementMap>& maps, const ResampleOptions& options,
            const std::stop_token& stop, LinearImage& out) {
    const auto stride = 4 * static_cast<std::ptrdiff_t>(in.data.width);
    const ImageView source{in.pixels.data(), in.data, 4, stride};
    resample(source, view_of(maps.front(), in.data), {out.pixels.data(), in.data, 4, stride}, options);
    // The samples are summed in order at each pixel, so that the result is the same for any number of threads.
    for (std::size_t m = 1; m < maps.size(); ++m) {
        check_stop(stop);
        std::vector<float>& instant = workspace().instant;
        instant.resize(in.pixels.size());
        resample(source, view_of(maps[m], in.data), {instant.data(), in.data, 4, stride}, options);
        for_rows(in.data.height, [&](int y) {
            const auto first = static_cast<std::size_t>(y) * static_cast<std::size_t>(stride);
            for (std::size_t i = first; i < first + static_cast<std::size_t>(stride); ++i) out.pixels[i] += instant[i];
        });
    }
}

void move_data(Part& part, const Part& source, const DataMover& mover, const DisplacementMap& map, Edge edge) {
    const PixelWindow window = data_window(part);
    const MapView view = view_of(map, window);
    const auto index = [&](int x, int y) {
        return static_cast<std::size_t>(y - window.y0) * static_cast<std::size_t>(window.width) +
               static_cast<std::size_t>(x - window.x0);
    };
    for_rows(window.height, [&](int row) {
        const float* d = view.data + row * view.stride;
        for (int c = 0; c < window.width; ++c) {
            if (d[2 * c] == 0 && d[2 * c + 1] == 0) continue;
            const int x = window.x0 + c, y = window.y0 + row;
            if (const auto from = nearest_source(x, y, d[2 * c], d[2 * c + 1], window, edge))
                mover.copy(source, index((*from)[0], (*from)[1]), part, index(x, y));
            else
                mover.clear(part, index(x, y));
        }
    });
}

std::size_t warp_picture(Picture& picture, const std::vector<DisplacementMap>& maps, const WarpSettings& settings) {
    std::size_t strange = 0;
    for (Part& part : picture.parts) {
        const PixelWindow window = data_window(part);
        const std::vector<std::uint8_t> moved = moved_pixels(maps, window);
        Workspace& space = workspace();
        for (const ChannelGroup& group : part.groups) {
            strange += load_group(part, group, space.in);
            warp_lanes(space.in, maps, settings, group.count == 3, space.out);
            store_group(part, group, space.out, moved);
        }
        const DataMover mover(part);
        if (mover.empty()) continue;
        const Part source = part;  // only the data channels are read, not the colour
        move_data(part, source, mover, maps[maps.size() / 2], settings.edge);
    }
    return strange;
}

}  // namespace

std::vector<std::uint8_t> moved_pixels(const std::vector<DisplacementMap>& maps, const PixelWindow& window) {
    std::vector<std::uint8_t> moved(window.area(), 0);
    for_rows(window.height, [&](int y) {
        std::uint8_t* out = moved.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(window.width);
        for (const DisplacementMap& map : maps) {
            const MapView view = view_of(map, window);
            const float* d = view.data + y * view.stride;
            for (int x = 0; x < window.width; ++x)
                out[x] = static_cast<std::uint8_t>(out[x] | static_cast<int>(d[2 * x] != 0) |
                                                   static_cast<int>(d[2 * x + 1] != 0));
        }
    });
    return moved;
}

void warp_lanes(const LinearImage& in, const std::vector<DisplacementMap>& maps, const WarpSettings& settings,
                bool colour, LinearImage& out) {
    ResampleOptions options{settings.filter, settings.edge, {1, 1, 1, 1}};
    if (colour && settings.dispersion != 0)
        options.channel_scale = {static_cast<float>(dispersion_scale(kRedWavelength, settings.dispersion)),
                                 static_cast<float>(dispersion_scale(kGreenWavelength, settings.dispersion)),
                                 static_cast<float>(dispersion_scale(kBlueWavelength, settings.dispersion)), 1};
    out.data = in.data;
    out.display = in.display;
    out.pixel_aspect = in.pixel_aspect;
    out.pixels.resize(in.pixels.size());
    add_up(in, maps, options, settings.stop, out);
    if (maps.size() == 1) return;
    const auto stride = 4 * static_cast<std::size_t>(in.data.width);
    const float share = 1.0f / static_cast<float>(maps.size());
    for_rows(in.data.height, [&](int y) {
        const std::size_t first = static_cast<std::size_t>(y) * stride;
        for (std::size_t i = first; i < first + stride; ++i) out.pixels[i] *= share;
    });
}

const Part& main_part(const Picture& picture) {
    for (const Part& part : picture.parts)
        for (const ChannelGroup& group : part.groups)
            if (group.count > 0) return part;
    return picture.parts.front();
}

PixelWindow plate_window(const Plate& plate) {
    if (const auto* frame = std::get_if<MovieFrame>(&plate)) return {0, 0, frame->format.width, frame->format.height};
    const auto& parts = std::get<Picture>(plate).parts;
    PixelWindow window = data_window(parts.front());
    for (const Part& part : parts) window = unite(window, data_window(part));
    return window;
}

PixelWindow plate_display(const Plate& plate) {
    if (const auto* frame = std::get_if<MovieFrame>(&plate)) return {0, 0, frame->format.width, frame->format.height};
    return display_window(std::get<Picture>(plate).parts.front());
}

std::size_t warp_plate(Plate& plate, const std::vector<DisplacementMap>& maps, const WarpSettings& settings) {
    if (auto* picture = std::get_if<Picture>(&plate)) return warp_picture(*picture, maps, settings);
    auto& frame = std::get<MovieFrame>(plate);
    Workspace& space = workspace();
    load_frame(frame, space.in);
    warp_lanes(space.in, maps, settings, !frame.format.gray, space.out);
    store_frame(frame, space.out, moved_pixels(maps, space.in.data));
    return 0;
}

LinearImage main_colour(const Plate& plate) {
    if (const auto* frame = std::get_if<MovieFrame>(&plate)) return load_frame(*frame);
    const Part& part = main_part(std::get<Picture>(plate));
    for (const ChannelGroup& group : part.groups)
        if (group.count > 0) return load_group(part, group);
    throw std::invalid_argument("a picture without colour");
}

}  // namespace eikonal
