/// Pictures as files hold them: every part, channel, window, metadatum and stored bit, and the colour in them as linear
/// light. The only module (with the movie library) that reads and writes images; all of it through OpenImageIO.
///
/// Conventions
///   - Row 0 on top, pixels as stored: interleaved, each channel in its own type (half RGB beside float Z and uint32
///   ids
///     stay what they are). Photographs that Exif says are to be turned are turned as they are read (orientation.h).
///   - Colour means light: warped in linear light, premultiplied by its layer's alpha, filtered. Data means numbers
///     (depth, ids, normals, vectors, mattes): moved, never filtered. warp/image/channels.h has the rule.
///   - Integer pictures are sRGB unless their metadata say otherwise; float ones are linear. Alpha is associated
///     (premultiplied) in EXR and wherever the file says so; PNG, TGA and such TIFF keep their unassociated codes in
///     memory. Linear light of a non-finite colour value: NaN counts as 0, infinity as the largest half.
///   - Of mip-mapped pictures only the full-size level is kept. Refused, with a clear message: deep and volume
///   pictures,
///     cube maps, subsampled luminance-chroma EXR.
///
/// Failures: FrameError "cannot read 'x.exr': reason" or "cannot write …", one line. A truncated EXR, PNG, TIFF or JPEG
/// (libjpeg itself only warns) is an error, never a half-black picture. Functions are safe to call from several threads
/// on different pictures; rows are processed in parallel by oneTBB.
#pragma once

#include <OpenImageIO/imageio.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "warp/image/transfer.h"
#include "warp/pixels/linear_image.h"

namespace eikonal {

enum class ChannelKind { Colour, Alpha, Data };

/// Up to three colour channels of one layer that are warped together, in the order R, G, B.
struct ChannelGroup {
    std::string layer;                           ///< "" for the main layer, "diffuse" for diffuse.R …
    std::array<int, 4> channel{-1, -1, -1, -1};  ///< indices of the colour channels; -1 beyond `count`
    int count = 0;                               ///< of colour channels, 0 (a lone alpha) … 3; 1 is grey
    int alpha = -1;                              ///< index of the layer's alpha channel, or -1
};

/// One part (subimage) of a file.
struct Part {
    OIIO::ImageSpec spec;
    std::vector<std::byte> pixels;  ///< native, interleaved: spec.pixel_bytes(true) a pixel, no padding
    std::vector<ChannelKind> kinds;
    std::vector<ChannelGroup> groups;
    Transfer transfer = Transfer::Linear;
    bool premultiplied = true;

    std::size_t pixel_bytes() const { return spec.pixel_bytes(true); }
    /// Bytes from the start of a pixel to channel `c`.
    std::size_t channel_offset(int c) const { return c == 0 ? 0 : spec.pixel_bytes(0, c, true); }
};

/// A file: at least one part.
struct Picture {
    std::vector<Part> parts;
    std::string format;  ///< OpenImageIO's name of the file format: "openexr", "png", …
};

PixelWindow data_window(const Part& part);
PixelWindow display_window(const Part& part);
/// Width over height of a pixel; 1 where the file does not say or says nonsense.
double pixel_aspect(const Part& part);

/// Reads a whole file. FrameError.
Picture read_picture(const std::filesystem::path& path);

/// Windows, channels and metadata only: parts have no pixels. FrameError, also for an empty or unreadable file.
Picture read_picture_header(const std::filesystem::path& path);

/// As read_picture_header, and looks whether the pixels are whole, without reading most of them: at the end mark of PNG
/// and JPEG, else at the first and the last row or tile of every part, one of which a truncated file lacks. FrameError.
Picture read_picture_ends(const std::filesystem::path& path);

/// Whether the extension is one of an image format that can be written.
bool can_write_picture(const std::filesystem::path& path);

/// Writes a picture under a temporary name and renames it when it is whole. The format is chosen by the
/// extension and must hold the picture (see picture_for_format). FrameError; nothing is left behind on failure.
void write_picture(const std::filesystem::path& path, const Picture& picture);

/// Colour of a group in linear light. The second form reuses the memory of `into`, and returns how many values (of
/// colour and alpha) are not finite as stored.
LinearImage load_group(const Part& part, const ChannelGroup& group);
std::size_t load_group(const Part& part, const ChannelGroup& group, LinearImage& into);

/// Encodes a group back where moved[i] != 0, one entry a pixel of the data window, row by row; all other pixels keep
/// their bytes. `image` must have the part's data window. Colour below zero alpha of unassociated formats becomes 0.
void store_group(Part& part, const ChannelGroup& group, const LinearImage& image, std::span<const std::uint8_t> moved);

/// Moves the Data channels of one part's pixels, byte by byte. Made once a part: it merges neighbouring channels.
class DataMover {
  public:
    explicit DataMover(const Part& part);

    /// Whether the part has no Data channel, hence nothing to move.
    bool empty() const { return runs_.empty(); }
    /// Copies pixel `from` of `source` to pixel `to` of `target`: indices in rows of their data windows. Both parts
    /// must have the channels of the part this was made from.
    void copy(const Part& source, std::size_t from, Part& target, std::size_t to) const;
    /// Sets the Data channels of a pixel to zero (edge mode black).
    void clear(Part& target, std::size_t to) const;

  private:
    struct Run {
        std::size_t offset, bytes;
    };
    std::vector<Run> runs_;
    std::size_t stride_;
};

/// A new picture from linear light, for the format that the extension names. EXR: half, or float if `source_bits` > 16,
/// linear, premultiplied, ZIP. Integer formats: sRGB, unassociated where that is the format's way; 16 bits where the
/// format has them and `source_bits` > 8 (DPX always), else 8. Formats without windows get the display window, padded
/// with zeros; formats without alpha lose it (colour stays premultiplied, that is, over black).
Picture picture_from_linear(const LinearImage& image, const std::filesystem::path& for_file, bool with_alpha,
                            int source_bits);

/// A picture fit for another file format than it was read from; the same format returns it untouched. Kept between
/// formats: the main colour layer with its alpha, encoded as picture_from_linear does it (16-bit codes become float in
/// EXR), and the metadata that are not about the old format's storage. Dropped: other parts, layers and data channels.
/// FrameError if the picture holds no colour.
Picture picture_for_format(Picture picture, const std::filesystem::path& for_file);

using Attribute = std::pair<std::string, std::variant<double, std::string>>;

/// Writes a float32 ZIP EXR with named channels (displacement maps, STMaps, slices of a field), atomically.
/// interleaved: data.area() * channel_names.size() values. FrameError.
void write_float_exr(const std::filesystem::path& path, const PixelWindow& data, const PixelWindow& display,
                     std::span<const std::string> channel_names, std::span<const float> interleaved,
                     std::span<const Attribute> attributes = {});

/// Configures OpenImageIO and OpenEXR for a pipeline of `threads` workers that read and write several frames at once.
/// Call once, before any file is touched.
void set_image_threads(int threads);

}  // namespace eikonal
