/// The arithmetic between movie codes and linear light: scaling, matrix, tone curve and chroma filters. movie_frame.cpp
/// uses it. Nothing here knows of frames.
///
/// Codes are integers of the format's depth. R'G'B' and linear light are 1 at reference white. They are unclipped and
/// odd about zero, so codes outside the gamut survive.
#pragma once

#include <vector>

#include "warp/image/movie_frame.h"
#include "warp/image/transfer.h"

namespace eikonal {

/// The curve of an H.273 transfer number. Power laws of 2.6 and 2.8 use the nearest curve that exists, 2.2. This only
/// affects how neighbouring pixels mix, since the same curve leads back to codes.
const TransferCurve& tone_curve(int transfer);

/// The scales between codes and R'G'B'.
struct CodeScale {
    explicit CodeScale(const MovieFormat& format);

    float luma_offset, luma_scale;      ///< value = (code - offset) / scale, also for R, G, B and grey
    float chroma_offset, chroma_scale;  ///< likewise, -0.5 … 0.5
    float alpha_scale;                  ///< largest code
    float kr, kg, kb;                   ///< Y' = kr R' + kg G' + kb B'
};

/// The enlargement and reduction of chroma along one dimension.
class ChromaFilter {
  public:
    /// log2_ratio: 0, 1 or 2. position: of the chroma sample within its cell: -1 at the first luma sample (cosited), 0
    /// in the centre, 1 at the last. smooth: reduce by a tent, for pictures whose colour is as sharp as their light.
    /// Else reduce by the exact inverse of the enlargement.
    ChromaFilter(int log2_ratio, int position, bool smooth);

    /// Luma position x lies at sample `index` + `fraction`. `index` may be -1 or one beyond the last.
    struct Position {
        int index;
        float fraction;
    };
    Position enlarge(int x) const;

    /// Chroma sample c is the sum of taps[k] times the value at luma position (c << log2_ratio) + first + k.
    int first() const { return first_; }
    const std::vector<float>& taps() const { return taps_; }
    int log2_ratio() const { return log2_ratio_; }

  private:
    int log2_ratio_, position_, first_ = 0;
    std::vector<float> taps_;
};
ChromaFilter horizontal_filter(const MovieFormat& format, bool smooth);
ChromaFilter vertical_filter(const MovieFormat& format, bool smooth);

}  // namespace eikonal
