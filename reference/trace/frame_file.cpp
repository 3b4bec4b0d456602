#include "reference/trace/frame_file.h"

#include <bit>
#include <cstring>

#include "warp/image/picture.h"
#include "warp/image/pixel_codec.h"

namespace eikonal::reference {
namespace {

/// Rounds to 18 significant bits. The last six bits of the mantissa are then zero, which packs well. Infinity stays.
float rounded_depth(float z) {
    return std::bit_cast<float>((std::bit_cast<std::uint32_t>(z) + 32u) & ~63u);
}

struct FloatPlane {
    const char* name;
    const std::vector<float>* values;
};

}  // namespace

void write_frame(const std::filesystem::path& file, const RenderedFrame& frame, Storage storage) {
    constexpr std::size_t kColorBytes = 8;
    std::vector<float> depth = frame.depth;
    if (storage == Storage::Compact)
        for (float& z : depth) z = rounded_depth(z);
    std::vector<FloatPlane> planes;
    for (const FloatPlane& plane : {FloatPlane{"Z", &depth},
                                    {"length", &frame.length},
                                    {"u", &frame.u},
                                    {"v", &frame.v},
                                    {"id", &frame.id},
                                    {"steps", &frame.steps},
                                    {"error", &frame.error},
                                    {"magnification", &frame.magnification}})
        if (!plane.values->empty()) planes.push_back(plane);
    const std::size_t pixel_bytes = kColorBytes + planes.size() * sizeof(float);

    Part part;
    part.spec = OIIO::ImageSpec(frame.width, frame.height, static_cast<int>(4 + planes.size()), OIIO::TypeDesc::HALF);
    part.spec.channelformats.assign(4, OIIO::TypeDesc::HALF);
    part.spec.channelnames = {"R", "G", "B", "A"};
    for (const FloatPlane& plane : planes) {
        part.spec.channelformats.push_back(OIIO::TypeDesc::FLOAT);
        part.spec.channelnames.emplace_back(plane.name);
    }
    part.spec.alpha_channel = 3;
    part.spec.z_channel = 4;
    part.spec.attribute("compression", storage == Storage::Exact ? "zip" : "dwaa:45");
    part.spec.attribute("oiio:ColorSpace", "Linear");
    const std::size_t area = frame.depth.size();
    part.pixels.resize(area * pixel_bytes);
    for (std::size_t c = 0; c < 4; ++c)
        encode_values(OIIO::TypeDesc::HALF, frame.color.data() + c, 4, part.pixels.data() + 2 * c, pixel_bytes, area);
    for (std::size_t c = 0; c < planes.size(); ++c)
        for (std::size_t i = 0; i < area; ++i)
            std::memcpy(part.pixels.data() + i * pixel_bytes + kColorBytes + c * sizeof(float), &(*planes[c].values)[i],
                        sizeof(float));
    write_picture(file, {{std::move(part)}, "openexr"});
}

}  // namespace eikonal::reference
