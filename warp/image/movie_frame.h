/// Movie frames as their codec holds them, and their conversion to linear light and back.
///
/// A frame keeps the planes of its source: Y, Cb, Cr (full or subsampled), or R, G, B, or grey, each with an optional
/// alpha plane, as integer codes of 8 to 16 bits. Only the warp needs linear light. It is made by our own interpolation
/// of chroma, matrix and tone curve. store_frame() rewrites only the codes of what moved. A still pixel keeps its
/// codes, bit for bit. Under 4:2:0 too: a chroma sample is rewritten only if a pixel of its cell moved.
///
/// Reading a code and writing it back gives the same code (within 1 for 16 bits). This holds for chroma too: the filter
/// that reduces it is the exact left inverse of the linear interpolation that enlarged it. It is exact for even sizes,
/// except within a sample of the border. Ratio 4 with centred siting is averaged instead.
///
/// Colour tags are numbers of ITU-T H.273, as movie files store them. 2 is "unspecified". What is unspecified or
/// unknown is read as follows. Matrix: BT.709 for pictures wider than 1279 or higher than 576, else BT.601. Transfer:
/// BT.709. Chroma siting: left. Range: limited for Y'CbCr, full for RGB and grey. Primaries are carried and never
/// converted.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "warp/pixels/linear_image.h"

namespace eikonal {

enum class CodeRange { Unspecified = 0, Limited = 1, Full = 2 };

/// Where chroma samples lie within their cell. The numbers are those of libav's AVChromaLocation.
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
    /// Whether frames of this format have plane 0 … 3.
    bool has_plane(int plane) const { return plane == 0 || (plane == 3 ? alpha : !gray); }

  private:
    bool subsampled(int plane) const { return !rgb && !gray && (plane == 1 || plane == 2); }
};

/// One frame. Planes are dense rows of codes, plane_width() x plane_height(). Absent planes are empty.
struct MovieFrame {
    MovieFormat format;
    std::array<std::vector<std::uint16_t>, 4> planes;  ///< Y Cb Cr A, R G B A, or Y - - A
    std::int64_t pts = 0;       ///< presentation time in the time base of the reader (or writer) it belongs to
    std::int64_t duration = 0;  ///< in the same units. 0 if unknown.
    int number = 0;             ///< counted from 1
};

/// A frame as premultiplied linear light. The data and the display window are the frame. Grey uses lane 0 only.
LinearImage load_frame(const MovieFrame& frame);
/// The same, written to `image`, whose memory is used again. Fresh memory would cost as much time as the conversion.
void load_frame(const MovieFrame& frame, LinearImage& image);

/// Writes `image` back where `moved` is not 0. moved: one flag for each pixel, row by row. `image` must have the
/// frame's size. Values beyond the range of codes are clipped to it. Where alpha is not positive, colour becomes black.
void store_frame(MovieFrame& frame, const LinearImage& image, std::span<const std::uint8_t> moved);

/// A frame made from a picture. It shows the display window, black where there is no data, clipped to 0 … 1. If the
/// format has no alpha plane, the picture lies over black. gray_picture: the picture uses lane 0 only.
MovieFrame frame_from_linear(const LinearImage& image, const MovieFormat& format, bool gray_picture = false);

}  // namespace eikonal
