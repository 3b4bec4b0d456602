/// Movie frames as their codec holds them, and the way to linear light and back.
///
/// A frame keeps the planes of its source: Y, Cb, Cr (full or subsampled), or R, G, B, or grey, each with an optional
/// alpha plane, as integer codes of 8 to 16 bits. Linear light is made for the warp only, by our own chroma
/// interpolation, matrix and tone curve, and store_frame() rewrites only the codes of what moved: a still pixel keeps
/// its codes bit-identical, even under 4:2:0, where a chroma sample is rewritten only if a pixel of its cell moved.
///
/// Reading a code and writing it back gives the same code (within 1 for 16 bits), chroma included: the filter that
/// reduces chroma is the exact left inverse of the linear interpolation that enlarged it (within a sample of the
/// border, even sizes; ratio 4 with centred siting is averaged instead).
///
/// Colour tags are numbers of ITU-T H.273, as movie files store them; 2 is "unspecified". What is unspecified or
/// unknown is read as: matrix BT.709 for pictures wider than 1279 or higher than 576, else BT.601; transfer BT.709;
/// chroma siting left; range limited for Y'CbCr, full for RGB and grey. Primaries are carried, never converted.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "warp/pixels/linear_image.h"

namespace eikonal {

enum class CodeRange { Unspecified = 0, Limited = 1, Full = 2 };

/// Where chroma samples lie within their cell; the numbers are those of libav's AVChromaLocation.
enum class ChromaSiting { Unspecified = 0, Left = 1, Center = 2, TopLeft = 3, Top = 4, BottomLeft = 5, Bottom = 6 };

/// Geometry and coding of every frame of a movie.
struct MovieFormat {
    int width = 0, height = 0;                 ///< luma pixels, > 0
    int depth = 8;                             ///< bits of a code, 8 … 16
    bool rgb = false;                          ///< planes are R, G, B instead of Y, Cb, Cr
    bool gray = false;                         ///< one plane
    bool alpha = false;                        ///< planes[3] holds straight (not premultiplied) full-range alpha
    int log2_chroma_w = 0, log2_chroma_h = 0;  ///< 0, 1 or 2: chroma is narrower and lower by these powers of two
    CodeRange range = CodeRange::Unspecified;
    int primaries = 2, transfer = 2, matrix = 2;  ///< H.273
    ChromaSiting siting = ChromaSiting::Unspecified;
    double pixel_aspect = 1;  ///< width / height of a pixel

    int plane_width(int plane) const { return subsampled(plane) ? -((-width) >> log2_chroma_w) : width; }
    int plane_height(int plane) const { return subsampled(plane) ? -((-height) >> log2_chroma_h) : height; }
    /// True for the planes (0 … 3) that frames of this format have.
    bool has_plane(int plane) const { return plane == 0 || (plane == 3 ? alpha : !gray); }

  private:
    bool subsampled(int plane) const { return !rgb && !gray && (plane == 1 || plane == 2); }
};

/// One frame. Planes are dense rows of codes, plane_width() x plane_height(); absent planes are empty.
struct MovieFrame {
    MovieFormat format;
    std::array<std::vector<std::uint16_t>, 4> planes;  ///< Y Cb Cr A, R G B A, or Y - - A
    std::int64_t pts = 0;       ///< presentation time in the time base of the reader (or writer) it belongs to
    std::int64_t duration = 0;  ///< in the same units; 0 if unknown
    int number = 0;             ///< counted from 1
};

/// Linear light, premultiplied; data and display window are both the frame. Grey uses lane 0 only.
LinearImage load_frame(const MovieFrame& frame);
/// The same into `image`, whose memory is used again: fresh memory costs as much time as the conversion.
void load_frame(const MovieFrame& frame, LinearImage& image);

/// Writes `image` back where `moved` (one flag a pixel, row by row) is not 0. `image` must have the frame's size.
/// Values beyond the range of codes are clipped to it; where alpha is not positive, colour becomes black.
void store_frame(MovieFrame& frame, const LinearImage& image, std::span<const std::uint8_t> moved);

/// A frame made of a picture alone: its display window, black where there is no data, clipped to 0 … 1. Without an
/// alpha plane the picture lies over black. `gray_picture`: the picture uses lane 0 only.
MovieFrame frame_from_linear(const LinearImage& image, const MovieFormat& format, bool gray_picture = false);

}  // namespace eikonal
