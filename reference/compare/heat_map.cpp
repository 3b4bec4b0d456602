#include "reference/compare/heat_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "warp/image/transfer.h"

namespace eikonal::reference {
namespace {

using Colour = std::array<int, 3>;  ///< sRGB codes

constexpr std::array<Colour, 7> kStops{
    {{6, 4, 16}, {54, 14, 92}, {126, 30, 108}, {196, 56, 76}, {240, 112, 40}, {250, 184, 64}, {252, 250, 196}}};
constexpr Colour kNoAnswer{96, 120, 104}, kPaper{255, 255, 255}, kInk{50, 54, 60};

Colour heat(double t) {
    const double s = std::clamp(t, 0.0, 1.0) * (kStops.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(s), kStops.size() - 2);
    Colour c{};
    for (std::size_t k = 0; k < 3; ++k)
        c[k] = static_cast<int>(std::lerp(kStops[i][k], kStops[i + 1][k], s - static_cast<double>(i)) + 0.5);
    return c;
}

/// Letters as rows of five bits. The highest bit is on the left.
using Glyph = std::array<unsigned, 7>;
constexpr int kGlyphWidth = 5, kGlyphHeight = 7, kAdvance = 6;
constexpr std::string_view kLetters = "0123456789.px";
constexpr std::array<Glyph, 13> kGlyphs{{{0b01110, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01110},
                                         {0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110},
                                         {0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111},
                                         {0b01110, 0b10001, 0b00001, 0b00110, 0b00001, 0b10001, 0b01110},
                                         {0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010},
                                         {0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110},
                                         {0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110},
                                         {0b11111, 0b00001, 0b00010, 0b00100, 0b00100, 0b01000, 0b01000},
                                         {0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110},
                                         {0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100},
                                         {0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b01100, 0b01100},
                                         {0b00000, 0b11110, 0b10001, 0b10001, 0b11110, 0b10000, 0b10000},
                                         {0b00000, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001, 0b00000}}};

class Canvas {
  public:
    Canvas(int width, int height) : width_(width), height_(height), codes_(static_cast<std::size_t>(width * height)) {
        std::fill(codes_.begin(), codes_.end(), kPaper);
    }
    void set(int x, int y, const Colour& c) {
        if (x >= 0 && y >= 0 && x < width_ && y < height_) codes_[static_cast<std::size_t>(y * width_ + x)] = c;
    }
    static int text_width(std::string_view text) { return kAdvance * static_cast<int>(text.size()) - 1; }
    /// Draws letters of kLetters and blanks. (x, y): upper left corner.
    void write(int x, int y, std::string_view text) {
        for (const char letter : text) {
            const std::size_t found = kLetters.find(letter);
            if (found != std::string_view::npos)
                for (int row = 0; row < kGlyphHeight; ++row)
                    for (int column = 0; column < kGlyphWidth; ++column)
                        if ((kGlyphs[found][static_cast<std::size_t>(row)] >> (kGlyphWidth - 1 - column) & 1U) != 0)
                            set(x + column, y + row, kInk);
            x += kAdvance;
        }
    }
    LinearImage linear() const {
        const std::span<const float, 256> light = TransferCurve::of(Transfer::SRGB).codes8();
        const PixelWindow window{0, 0, width_, height_};
        LinearImage image{window, window, 1, std::vector<float>(4 * window.area(), 1.0f)};
        for (std::size_t i = 0; i < codes_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) image.pixels[4 * i + c] = light[static_cast<std::size_t>(codes_[i][c])];
        return image;
    }

  private:
    int width_, height_;
    std::vector<Colour> codes_;
};

}  // namespace

double scale_end(double largest) {
    double end = 0.001;
    for (int i = 0; end < largest && end < 1e9; ++i) end *= i % 3 == 1 ? 2.5 : 2;
    return end;
}

LinearImage heat_map(std::span<const float> error, int width, int height, double end) {
    constexpr int kGap = 3, kBar = 9;
    Canvas canvas(width, height + kScaleHeight);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float e =
                error[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
            canvas.set(x, y, e < 0 ? kNoAnswer : heat(e / end));
        }
    for (int y = height + kGap; y < height + kGap + kBar; ++y)
        for (int x = 0; x < width; ++x) canvas.set(x, y, heat((x + 0.5) / width));
    const int row = height + kScaleHeight - kGlyphHeight - 3;
    const std::string last = fmt::format("{:.4g} px", end), middle = fmt::format("{:.4g}", end / 2);
    canvas.write(1, row, "0");
    canvas.write(width - 1 - Canvas::text_width(last), row, last);
    if (width >= 2 * Canvas::text_width(last) + 2 * Canvas::text_width(middle))
        canvas.write((width - Canvas::text_width(middle)) / 2, row, middle);
    return canvas.linear();
}

std::string heat_gradient() {
    std::string stops;
    for (const Colour& c : kStops) stops += fmt::format(",rgb({},{},{})", c[0], c[1], c[2]);
    return "linear-gradient(to right" + stops + ")";
}

}  // namespace eikonal::reference
