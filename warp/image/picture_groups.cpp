#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "warp/image/picture.h"
#include "warp/image/pixel_codec.h"
#include "warp/pixels/rows.h"

namespace eikonal {
namespace {

using OIIO::TypeDesc;

/// The places of a group's channels in the stored pixel.
struct Lane {
    int lane;
    std::size_t offset;
    TypeDesc::BASETYPE type;
};

struct Layout {
    std::vector<Lane> colours;
    Lane alpha{3, 0, TypeDesc::UNKNOWN};
    bool has_alpha = false;
    std::size_t pixel_bytes = 0, width = 0, height = 0;
    const TransferCurve* curve = nullptr;
    bool premultiplied = true;
    TypeDesc::BASETYPE packed = TypeDesc::UNKNOWN;  ///< HALF or FLOAT: the pixel is just this group's linear RGBA

    Layout(const Part& part, const ChannelGroup& group)
        : has_alpha(group.alpha >= 0),
          pixel_bytes(part.pixel_bytes()),
          width(static_cast<std::size_t>(part.spec.width)),
          height(static_cast<std::size_t>(part.spec.height)),
          curve(&TransferCurve::of(part.transfer)),
          premultiplied(part.premultiplied) {
        const auto place = [&](int lane, int channel) {
            const auto type = static_cast<TypeDesc::BASETYPE>(part.spec.channelformat(channel).basetype);
            return Lane{lane, part.channel_offset(channel), type};
        };
        for (int i = 0; i < group.count; ++i) colours.push_back(place(i, group.channel[static_cast<std::size_t>(i)]));
        if (!has_alpha) return;
        alpha = place(3, group.alpha);
        const bool simple = colours.size() == 3 && premultiplied && curve->linear();
        const std::size_t bytes = TypeDesc(alpha.type).size();
        bool contiguous = simple && pixel_bytes == 4 * bytes && alpha.offset == 3 * bytes;
        for (const Lane& colour : colours)
            contiguous = contiguous && colour.type == alpha.type &&
                         colour.offset == static_cast<std::size_t>(colour.lane) * bytes;
        if (contiguous && (alpha.type == TypeDesc::HALF || alpha.type == TypeDesc::FLOAT)) packed = alpha.type;
    }
};

/// Codes of one channel to floats. If `curve` is given and the type is an integer of 8 or 16 bits, a table look-up
/// gives linear light at once. Returns whether it did so.
bool decode_codes(const Lane& lane, const TransferCurve* curve, const std::byte* row, const Layout& layout,
                  float* out) {
    const std::byte* at = row + lane.offset;
    float* to = out + lane.lane;
    if (curve != nullptr && lane.type == TypeDesc::UINT8) {
        const auto table = curve->codes8();
        for (std::size_t i = 0; i < layout.width; ++i, at += layout.pixel_bytes)
            to[4 * i] = table[static_cast<std::uint8_t>(*at)];
        return true;
    }
    if (curve != nullptr && lane.type == TypeDesc::UINT16) {
        const auto table = curve->codes16();
        for (std::size_t i = 0; i < layout.width; ++i, at += layout.pixel_bytes) {
            std::uint16_t code;
            std::memcpy(&code, at, sizeof code);
            to[4 * i] = table[code];
        }
        return true;
    }
    decode_values(lane.type, at, layout.pixel_bytes, to, 4, layout.width);
    return false;
}

/// Returns how many stored values are not finite.
std::size_t load_row(const Layout& layout, const std::byte* row, float* out) {
    const std::size_t n = layout.width;
    if (layout.packed == TypeDesc::HALF)
        return decode_half_finite(reinterpret_cast<const std::uint16_t*>(row), out, 4 * n);
    if (layout.packed == TypeDesc::FLOAT) {
        std::memcpy(out, row, 4 * n * sizeof(float));
        return make_finite(out, 4 * n);
    }

    std::fill(out, out + 4 * n, 0.0f);
    if (layout.has_alpha)
        decode_codes(layout.alpha, nullptr, row, layout, out);
    else
        for (std::size_t i = 0; i < n; ++i) out[4 * i + 3] = 1.0f;

    const TransferCurve& curve = *layout.curve;
    // These codes were premultiplied before they were encoded for display. So divide, linearise, multiply.
    const bool divide = layout.has_alpha && layout.premultiplied && !curve.linear();
    for (const Lane& colour : layout.colours) {
        const bool done = decode_codes(colour, divide ? nullptr : &curve, row, layout, out);
        if (done || curve.linear()) continue;
        float* values = out + colour.lane;
        for (std::size_t i = 0; i < n; ++i) {
            const float alpha = out[4 * i + 3];
            const float scale = divide && alpha > 0 ? alpha : 1.0f;
            values[4 * i] = curve.to_linear(values[4 * i] / scale) * scale;
        }
    }
    const std::size_t strange = make_finite(out, 4 * n);
    if (layout.has_alpha && !layout.premultiplied)
        for (const Lane& colour : layout.colours)
            for (std::size_t i = 0; i < n; ++i) out[4 * i + static_cast<std::size_t>(colour.lane)] *= out[4 * i + 3];
    return strange;
}

/// Linear values of one channel (four floats apart) to codes of its type.
void encode_channel(const Lane& lane, const TransferCurve& curve, const float* values, std::byte* at,
                    std::size_t stride, std::size_t count, std::vector<float>& codes) {
    if (curve.linear()) return encode_values(lane.type, values, 4, at, stride, count);
    codes.resize(count);
    for (std::size_t i = 0; i < count; ++i) codes[i] = values[4 * i];
    curve.from_linear(codes);
    encode_values(lane.type, codes.data(), 1, at, stride, count);
}

/// Memory that a row's spans share.
struct Scratch {
    std::vector<float> pixels, codes;
};

/// Encodes whole pixels first … first + count - 1 of a row.
void store_span(const Layout& layout, const float* linear, std::byte* row, std::size_t first, std::size_t count,
                Scratch& scratch) {
    const float* in = linear + 4 * first;
    std::byte* out = row + first * layout.pixel_bytes;
    if (layout.packed == TypeDesc::HALF) return encode_half(in, reinterpret_cast<std::uint16_t*>(out), 4 * count);

    const TransferCurve& curve = *layout.curve;
    const bool divide = layout.has_alpha && (!layout.premultiplied || !curve.linear());
    if (divide) {
        scratch.pixels.assign(in, in + 4 * count);
        for (std::size_t i = 0; i < count; ++i) {
            float* pixel = scratch.pixels.data() + 4 * i;
            const float scale = pixel[3] > 0 ? 1.0f / pixel[3] : 0.0f;
            for (std::size_t lane = 0; lane < 3; ++lane) pixel[lane] *= scale;
        }
        if (layout.premultiplied) {  // encode the straight colour, then multiply by alpha
            curve.from_linear(scratch.pixels);
            for (std::size_t i = 0; i < count; ++i)
                for (std::size_t lane = 0; lane < 3; ++lane) scratch.pixels[4 * i + lane] *= in[4 * i + 3];
        }
    }
    const TransferCurve& last = divide && layout.premultiplied ? TransferCurve::of(Transfer::Linear) : curve;
    const float* colours = divide ? scratch.pixels.data() : in;
    for (const Lane& colour : layout.colours)
        encode_channel(colour, last, colours + colour.lane, out + colour.offset, layout.pixel_bytes, count,
                       scratch.codes);
    if (layout.has_alpha)
        encode_values(layout.alpha.type, in + 3, 4, out + layout.alpha.offset, layout.pixel_bytes, count);
}

}  // namespace

std::size_t load_group(const Part& part, const ChannelGroup& group, LinearImage& into) {
    const Layout layout(part, group);
    into.data = data_window(part);
    into.display = display_window(part);
    into.pixel_aspect = pixel_aspect(part);
    into.pixels.resize(4 * layout.width * layout.height);
    std::atomic<std::size_t> strange{0};
    for_rows(layout.height, [&](std::size_t y) {
        strange.fetch_add(load_row(layout, part.pixels.data() + y * layout.width * layout.pixel_bytes,
                                   into.pixels.data() + 4 * y * layout.width),
                          std::memory_order_relaxed);
    });
    return strange;
}

LinearImage load_group(const Part& part, const ChannelGroup& group) {
    LinearImage image;
    load_group(part, group, image);
    return image;
}

void store_group(Part& part, const ChannelGroup& group, const LinearImage& image, std::span<const std::uint8_t> moved) {
    const Layout layout(part, group);
    if (image.data != data_window(part) || moved.size() != layout.width * layout.height ||
        image.pixels.size() != 4 * moved.size())
        throw std::logic_error("store_group: the image does not have the part's data window");
    for_rows(layout.height, [&](std::size_t y) {
        Scratch scratch;
        const std::uint8_t* mask = moved.data() + y * layout.width;
        const float* linear = image.pixels.data() + 4 * y * layout.width;
        std::byte* row = part.pixels.data() + y * layout.width * layout.pixel_bytes;
        for (std::size_t x = 0; x < layout.width;) {  // one run of moved pixels after the other
            if (mask[x] == 0) {
                ++x;
                continue;
            }
            const void* end = std::memchr(mask + x, 0, layout.width - x);
            const std::size_t stop =
                end == nullptr ? layout.width : static_cast<std::size_t>(static_cast<const std::uint8_t*>(end) - mask);
            store_span(layout, linear, row, x, stop - x, scratch);
            x = stop;
        }
    });
}

DataMover::DataMover(const Part& part) : stride_(part.pixel_bytes()) {
    for (std::size_t c = 0; c < part.kinds.size(); ++c) {
        if (part.kinds[c] != ChannelKind::Data) continue;
        const int channel = static_cast<int>(c);
        const std::size_t offset = part.channel_offset(channel);
        const std::size_t bytes = part.spec.channelformat(channel).size();
        if (!runs_.empty() && runs_.back().offset + runs_.back().bytes == offset)
            runs_.back().bytes += bytes;
        else
            runs_.push_back({offset, bytes});
    }
}

void DataMover::copy(const Part& source, std::size_t from, Part& target, std::size_t to) const {
    for (const Run& run : runs_)
        std::memcpy(target.pixels.data() + to * stride_ + run.offset,
                    source.pixels.data() + from * stride_ + run.offset, run.bytes);
}

void DataMover::clear(Part& target, std::size_t to) const {
    for (const Run& run : runs_) std::memset(target.pixels.data() + to * stride_ + run.offset, 0, run.bytes);
}

}  // namespace eikonal
