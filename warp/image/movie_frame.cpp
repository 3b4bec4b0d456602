#include "warp/image/movie_frame.h"

#include <algorithm>
#include <stdexcept>

#include "noise/base/instruction_sets.h"
#include "warp/image/movie_colour.h"
#include "warp/pixels/rows.h"

namespace eikonal {

namespace {

std::size_t at(int row, int width) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
}

EIKONAL_CLONES void codes_to_values(const std::uint16_t* codes, float* values, int count, float offset, float scale) {
    for (int x = 0; x < count; ++x) values[x] = (static_cast<float>(codes[x]) - offset) / scale;
}

EIKONAL_CLONES void ycc_to_rgb(const CodeScale& scale, const float* y, const float* cb, const float* cr, float* rgb,
                               int count) {
    const float to_r = 2 * (1 - scale.kr), to_b = 2 * (1 - scale.kb);
    const float g_from_b = to_b * scale.kb / scale.kg, g_from_r = to_r * scale.kr / scale.kg;
    float *r = rgb, *g = rgb + count, *b = rgb + 2 * count;
    for (int x = 0; x < count; ++x) {
        r[x] = y[x] + to_r * cr[x];
        g[x] = y[x] - g_from_b * cb[x] - g_from_r * cr[x];
        b[x] = y[x] + to_b * cb[x];
    }
}

EIKONAL_CLONES void rgb_to_ycc(const CodeScale& scale, const float* rgb, float* y, float* cb, float* cr, int count) {
    const float from_r = 0.5F / (1 - scale.kr), from_b = 0.5F / (1 - scale.kb);
    const float *r = rgb, *g = rgb + count, *b = rgb + 2 * count;
    for (int x = 0; x < count; ++x) {
        y[x] = scale.kr * r[x] + scale.kg * g[x] + scale.kb * b[x];
        cb[x] = (b[x] - y[x]) * from_b;
        cr[x] = (r[x] - y[x]) * from_r;
    }
}

EIKONAL_CLONES void interleave(const float* rgb, const float* alpha, float* pixels, int count) {
    for (int x = 0; x < count; ++x) {
        const float a = alpha[x];
        pixels[4 * x] = rgb[x] * a;
        pixels[4 * x + 1] = rgb[count + x] * a;
        pixels[4 * x + 2] = rgb[2 * count + x] * a;
        pixels[4 * x + 3] = a;
    }
}

/// Straight colour in three runs. Without alpha, the picture's premultiplied colour is taken as it is.
EIKONAL_CLONES void deinterleave(const float* pixels, float* rgb, int count) {
    for (int x = 0; x < count; ++x) {
        rgb[x] = pixels[4 * x];
        rgb[count + x] = pixels[4 * x + 1];
        rgb[2 * count + x] = pixels[4 * x + 2];
    }
}

EIKONAL_CLONES void unpremultiply(float* rgb, const float* alpha, int count) {
    for (int x = 0; x < count; ++x) {
        const float gain = alpha[x] > 0 ? 1 / alpha[x] : 0.0F;
        rgb[x] *= gain;
        rgb[count + x] *= gain;
        rgb[2 * count + x] *= gain;
    }
}

/// Codes of values where `chosen` is not 0. NaN and negative codes become 0.
EIKONAL_CLONES void values_to_codes(const float* __restrict values, const std::uint8_t* __restrict chosen,
                                    std::uint16_t* __restrict codes, int count, float offset, float scale,
                                    float largest) {
    for (int x = 0; x < count; ++x) {
        float code = values[x] * scale + offset + 0.5F;
        code = code > 0 ? code : 0;
        code = code < largest ? code : largest;
        const auto rounded = static_cast<std::uint16_t>(static_cast<std::int32_t>(code));
        codes[x] = chosen[x] != 0 ? rounded : codes[x];
    }
}

void check(const MovieFrame& frame) {
    for (int plane = 0; plane < 4; ++plane) {
        const auto expected = frame.format.has_plane(plane)
                                  ? at(frame.format.plane_height(plane), frame.format.plane_width(plane))
                                  : std::size_t{0};
        if (frame.planes[static_cast<std::size_t>(plane)].size() != expected)
            throw std::logic_error("a movie frame's planes do not match its format");
    }
}

/// Enlarges one chroma plane to full-width rows of values.
class ChromaRows {
  public:
    ChromaRows(const MovieFrame& frame, const CodeScale& scale)
        : frame_(frame),
          scale_(scale),
          across_(horizontal_filter(frame.format, false)),
          down_(vertical_filter(frame.format, false)) {}

    /// values: frame width. `sample_row` is scratch.
    void row(int plane, int y, std::vector<float>& sample_row, float* values) const {
        const MovieFormat& format = frame_.format;
        const int width = format.plane_width(plane), height = format.plane_height(plane);
        const auto& codes = frame_.planes[static_cast<std::size_t>(plane)];
        const auto [index, fraction] = down_.enlarge(y);
        const std::uint16_t* upper = codes.data() + at(std::clamp(index, 0, height - 1), width);
        const std::uint16_t* lower = codes.data() + at(std::clamp(index + 1, 0, height - 1), width);
        // One more sample on each side, so that the enlargement needs no test of the border.
        sample_row.resize(static_cast<std::size_t>(width) + 2);
        float* samples = sample_row.data() + 1;
        for (int x = 0; x < width; ++x) {
            const auto a = static_cast<float>(upper[x]), b = static_cast<float>(lower[x]);
            samples[x] = (a + (b - a) * fraction - scale_.chroma_offset) / scale_.chroma_scale;
        }
        samples[-1] = samples[0];
        samples[width] = samples[width - 1];
        if (across_.log2_ratio() == 0) {
            std::copy_n(samples, width, values);
            return;
        }
        const int ratio = 1 << across_.log2_ratio();
        for (int phase = 0; phase < ratio; ++phase) {
            const auto position = across_.enlarge(phase);
            const float* left = samples + position.index;
            for (int x = phase, c = 0; x < format.width; x += ratio, ++c)
                values[x] = left[c] + (left[c + 1] - left[c]) * position.fraction;
        }
    }

  private:
    const MovieFrame& frame_;
    const CodeScale& scale_;
    ChromaFilter across_, down_;
};

/// Writes linear pixels into a frame's planes.
class FrameStore {
  public:
    /// moved: empty for every pixel. clip: clip R'G'B' to 0 … 1, and reduce chroma smoothly.
    FrameStore(MovieFrame& frame, const LinearImage& image, std::span<const std::uint8_t> moved, bool clip, bool gray)
        : frame_(frame),
          format_(frame.format),
          image_(image),
          moved_(moved),
          clip_(clip),
          gray_(gray),
          scale_(format_),
          curve_(tone_curve(format_.transfer)),
          largest_(scale_.alpha_scale),
          across_(horizontal_filter(format_, clip)),
          down_(vertical_filter(format_, clip)) {}

    void run() {
        if (moved_.empty()) all_.assign(static_cast<std::size_t>(format_.width), 1);
        find_rows();
        const bool chroma = !format_.rgb && !format_.gray;
        if (chroma)
            for (auto& plane : reduced_) plane.resize(at(format_.height, format_.plane_width(1)));
        for_row_runs(format_.height, [&](int begin, int end) {
            std::vector<float> scratch(static_cast<std::size_t>(format_.width) * 6);
            for (int y = begin; y < end; ++y)
                if (needed_[static_cast<std::size_t>(y)]) store_row(y, scratch.data());
        });
        if (chroma)
            for_row_runs(format_.plane_height(1), [&](int begin, int end) {
                for (int c = begin; c < end; ++c) store_chroma_row(c);
            });
    }

  private:
    const std::uint8_t* moved_row(int y) const {
        return moved_.empty() ? all_.data() : moved_.data() + at(y, format_.width);
    }

    /// A row is needed if it has moved pixels, or lies within reach of the chroma filter of one that has.
    void find_rows() {
        needed_.assign(static_cast<std::size_t>(format_.height), 0);
        const int reach = static_cast<int>(down_.taps().size()) + (1 << format_.log2_chroma_h);
        for (int y = 0; y < format_.height; ++y) {
            const std::uint8_t* row = moved_row(y);
            if (std::all_of(row, row + format_.width, [](std::uint8_t m) { return m == 0; })) continue;
            for (int near = std::max(0, y - reach); near <= std::min(format_.height - 1, y + reach); ++near)
                needed_[static_cast<std::size_t>(near)] = 1;
        }
    }

    void store_plane_row(int plane, int y, const float* values, float offset, float scale) {
        std::uint16_t* codes = frame_.planes[static_cast<std::size_t>(plane)].data() + at(y, format_.width);
        values_to_codes(values, moved_row(y), codes, format_.width, offset, scale, largest_);
    }

    void store_row(int y, float* scratch) {
        const int width = format_.width;
        float *rgb = scratch, *luma = scratch + 3 * width, *cb = scratch + 4 * width, *cr = scratch + 5 * width;
        read_row(y, rgb, luma);
        if (format_.alpha) store_plane_row(3, y, luma, 0, scale_.alpha_scale);
        curve_.from_linear(std::span(rgb, static_cast<std::size_t>(3 * width)));
        if (clip_)
            for (int i = 0; i < 3 * width; ++i) rgb[i] = std::clamp(rgb[i], 0.0F, 1.0F);
        if (format_.gray && gray_) {
            store_plane_row(0, y, rgb, scale_.luma_offset, scale_.luma_scale);
            return;
        }
        if (format_.rgb) {
            for (int plane = 0; plane < 3; ++plane)
                store_plane_row(plane, y, rgb + plane * width, scale_.luma_offset, scale_.luma_scale);
            return;
        }
        rgb_to_ycc(scale_, rgb, luma, cb, cr, width);
        store_plane_row(0, y, luma, scale_.luma_offset, scale_.luma_scale);
        if (format_.gray) return;
        reduce_row(cb, reduced_[0].data() + at(y, format_.plane_width(1)));
        reduce_row(cr, reduced_[1].data() + at(y, format_.plane_width(1)));
    }

    /// Straight linear colour in three runs, and alpha if the format has it.
    void read_row(int y, float* rgb, float* alpha) const {
        const int width = format_.width;
        const float* pixels = image_.pixels.data() + 4 * at(y, width);
        deinterleave(pixels, rgb, width);
        if (gray_)
            for (int lane = 1; lane < 3; ++lane) std::copy_n(rgb, width, rgb + lane * width);
        if (!format_.alpha) return;
        for (int x = 0; x < width; ++x) alpha[x] = pixels[4 * x + 3];
        unpremultiply(rgb, alpha, width);
    }

    void reduce_row(const float* values, float* samples) const {
        const int count = format_.plane_width(1), last = format_.width - 1;
        if (across_.log2_ratio() == 0) {
            std::copy_n(values, count, samples);
            return;
        }
        const auto& taps = across_.taps();
        const int size = static_cast<int>(taps.size()), step = 1 << across_.log2_ratio();
        const auto slow = [&](int c) {
            float sum = 0;
            for (int k = 0; k < size; ++k)
                sum += taps[static_cast<std::size_t>(k)] * values[std::clamp(c * step + across_.first() + k, 0, last)];
            samples[c] = sum;
        };
        // Samples whose taps all lie inside the row need no clamping.
        const int begin = std::min(count, (-across_.first() + step - 1) / step);
        const int end = std::max(begin, std::min(count, (last - size + 1 - across_.first()) / step + 1));
        for (int c = 0; c < begin; ++c) slow(c);
        std::fill(samples + begin, samples + end, 0.0F);
        for (int k = 0; k < size; ++k) {
            const float tap = taps[static_cast<std::size_t>(k)];
            const float* from = values + across_.first() + k;
            for (int c = begin; c < end; ++c) samples[c] += tap * from[c * step];
        }
        for (int c = end; c < count; ++c) slow(c);
    }

    /// One flag for each chroma sample of row c: whether a pixel of its cell moved.
    std::vector<std::uint8_t> moved_cells(int c) const {
        std::vector<std::uint8_t> cells(static_cast<std::size_t>(format_.plane_width(1)), 0);
        const int bottom = std::min((c + 1) << format_.log2_chroma_h, format_.height);
        for (int y = c << format_.log2_chroma_h; y < bottom; ++y) {
            const std::uint8_t* row = moved_row(y);
            for (int x = 0; x < format_.width; ++x)
                cells[static_cast<std::size_t>(x >> format_.log2_chroma_w)] |= row[x];
        }
        return cells;
    }

    void store_chroma_row(int c) {
        const int first_row = c << format_.log2_chroma_h;
        if (!needed_[static_cast<std::size_t>(first_row)]) return;
        const int width = format_.plane_width(1);
        const auto& taps = down_.taps();
        const std::vector<std::uint8_t> cells = moved_cells(c);
        for (std::size_t plane = 0; plane < 2; ++plane) {
            std::vector<float> sums(static_cast<std::size_t>(width), 0.0F);
            for (std::size_t k = 0; k < taps.size(); ++k) {
                const int y = std::clamp(first_row + down_.first() + static_cast<int>(k), 0, format_.height - 1);
                const float* samples = reduced_[plane].data() + at(y, width);
                for (int x = 0; x < width; ++x) sums[static_cast<std::size_t>(x)] += taps[k] * samples[x];
            }
            std::uint16_t* codes = frame_.planes[plane + 1].data() + at(c, width);
            values_to_codes(sums.data(), cells.data(), codes, width, scale_.chroma_offset, scale_.chroma_scale,
                            largest_);
        }
    }

    MovieFrame& frame_;
    const MovieFormat& format_;
    const LinearImage& image_;
    std::span<const std::uint8_t> moved_;
    bool clip_, gray_;
    CodeScale scale_;
    const TransferCurve& curve_;
    float largest_;
    ChromaFilter across_, down_;
    std::vector<std::uint8_t> all_;  ///< a row of flags for an empty `moved_`
    std::vector<std::uint8_t> needed_;
    std::array<std::vector<float>, 2> reduced_;
};

}  // namespace

LinearImage load_frame(const MovieFrame& frame) {
    LinearImage image;
    load_frame(frame, image);
    return image;
}

void load_frame(const MovieFrame& frame, LinearImage& image) {
    check(frame);
    const MovieFormat& format = frame.format;
    const int width = format.width;
    const CodeScale scale(format);
    const TransferCurve& curve = tone_curve(format.transfer);
    const ChromaRows chroma(frame, scale);
    image.data = image.display = {0, 0, width, format.height};
    image.pixel_aspect = format.pixel_aspect;
    image.pixels.resize(at(format.height, width) * 4);
    const int lanes = format.gray ? 1 : 3;
    for_row_runs(format.height, [&](int begin, int end) {
        const auto count = static_cast<std::size_t>(width);
        std::vector<float> rgb(3 * count), planes(3 * count), alpha(count, 1.0F), samples;
        for (int y = begin; y < end; ++y) {
            const auto values = [&](int plane, float* to, float offset, float unit) {
                codes_to_values(frame.planes[static_cast<std::size_t>(plane)].data() + at(y, width), to, width, offset,
                                unit);
            };
            if (format.rgb || format.gray) {
                for (int plane = 0; plane < lanes; ++plane)
                    values(plane, rgb.data() + plane * width, scale.luma_offset, scale.luma_scale);
            } else {
                values(0, planes.data(), scale.luma_offset, scale.luma_scale);
                chroma.row(1, y, samples, planes.data() + width);
                chroma.row(2, y, samples, planes.data() + 2 * width);
                ycc_to_rgb(scale, planes.data(), planes.data() + width, planes.data() + 2 * width, rgb.data(), width);
            }
            curve.to_linear(std::span(rgb.data(), static_cast<std::size_t>(lanes * width)));
            if (format.alpha) values(3, alpha.data(), 0, scale.alpha_scale);
            interleave(rgb.data(), alpha.data(), image.pixels.data() + 4 * at(y, width), width);
        }
    });
}

void store_frame(MovieFrame& frame, const LinearImage& image, std::span<const std::uint8_t> moved) {
    check(frame);
    const auto area = at(frame.format.height, frame.format.width);
    if (image.data.width != frame.format.width || image.data.height != frame.format.height || moved.size() != area)
        throw std::logic_error("store_frame: picture, mask and frame differ in size");
    FrameStore(frame, image, moved, false, frame.format.gray).run();
}

MovieFrame frame_from_linear(const LinearImage& image, const MovieFormat& format, bool gray_picture) {
    if (image.display.width != format.width || image.display.height != format.height)
        throw std::logic_error("frame_from_linear: the display window is not of the movie's size");
    MovieFrame frame;
    frame.format = format;
    for (int plane = 0; plane < 4; ++plane)
        if (format.has_plane(plane))
            frame.planes[static_cast<std::size_t>(plane)].resize(
                at(format.plane_height(plane), format.plane_width(plane)));
    if (image.data == image.display)
        FrameStore(frame, image, {}, true, gray_picture).run();
    else
        FrameStore(frame, cropped(image, image.display), {}, true, gray_picture).run();
    return frame;
}

}  // namespace eikonal
