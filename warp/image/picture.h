/// Pictures as files hold them: every part, channel, window, metadatum and stored bit, and their colour as linear
/// light. Only this module and the movie modules read and write images. All of it goes through OpenImageIO.
///
/// Conventions
///   - Row 0 is on top. Pixels are as stored: interleaved, each channel in its own type. Half RGB beside float Z and
///   uint32
///     ids stay as they are. Photographs that Exif says are turned are turned upright when they are read
///     (orientation.h).
///   - Colour is light. It is warped in linear light, premultiplied by its layer's alpha, and filtered. Data are
///   numbers
///     (depth, ids, normals, vectors, mattes). They are moved and never filtered. warp/image/channels.h has the rule.
///   - Integer pictures are sRGB unless their metadata say otherwise. Float pictures are linear. In linear light NaN
///   counts
///     as 0, and infinity as the largest half.
///   - Alpha is associated (premultiplied) in EXR and wherever the file says so. PNG, TGA and such TIFF keep their
///     unassociated codes in memory.
///   - Only the full-size level of a mip-mapped picture is kept. Deep and volume pictures, cube maps and EXR with
///     subsampled luminance and chroma are refused with a clear message.
///
/// Failures: FrameError "cannot read 'x.exr': reason" or "cannot write …", one line. A truncated EXR, PNG, TIFF or JPEG
/// is an error and never a half-black picture, although libjpeg itself only warns. Functions may be called from several
/// threads on different pictures. oneTBB processes rows in parallel.
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
    std::vector<std::byte> pixels;  ///< native, interleaved, without padding: spec.pixel_bytes(true) a pixel
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
/// Width over height of a pixel. 1 where the file states none, or states nonsense.
double pixel_aspect(const Part& part);

/// Reads a whole file. FrameError.
Picture read_picture(const std::filesystem::path& path);

/// Reads windows, channels and metadata. Parts have no pixels. FrameError, also for an empty or unreadable file.
Picture read_picture_header(const std::filesystem::path& path);

/// As read_picture_header, and checks that the pixels are whole without reading most of them. PNG and JPEG must have
/// their end mark. Other files must have the first and the last row or tile of every part, of which a truncated file
/// lacks one. FrameError.
Picture read_picture_ends(const std::filesystem::path& path);

/// Whether the extension is one of an image format that can be written.
bool can_write_picture(const std::filesystem::path& path);

/// Writes a picture under a temporary name and renames it when it is whole. The extension chooses the format, which
/// must be able to hold the picture (picture_for_format). FrameError. A failure leaves nothing behind.
void write_picture(const std::filesystem::path& path, const Picture& picture);

/// Colour of a group in linear light. The second form uses the memory of `into` again. It returns how many stored
/// values of colour and alpha are not finite.
LinearImage load_group(const Part& part, const ChannelGroup& group);
std::size_t load_group(const Part& part, const ChannelGroup& group, LinearImage& into);

/// Encodes a group back where moved[i] != 0. `moved` has one entry for each pixel of the data window, row by row. All
/// other pixels keep their bytes. `image` must have the part's data window. Where alpha is zero or less, the colour of
/// unassociated formats becomes 0.
void store_group(Part& part, const ChannelGroup& group, const LinearImage& image, std::span<const std::uint8_t> moved);

/// Moves the Data channels of one part's pixels, byte by byte. It merges neighbouring channels, so make it once a part.
class DataMover {
  public:
    explicit DataMover(const Part& part);

    /// Whether the part has no Data channel to move.
    bool empty() const { return runs_.empty(); }
    /// Copies pixel `from` of `source` to pixel `to` of `target`. Pixels are indices into the data windows, row by row.
    /// Both parts must have the channels of the constructor's part.
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

/// A new picture from linear light, for the format that the extension names.
///   EXR               half, or float if `source_bits` > 16; linear, premultiplied, ZIP
///   integer formats   sRGB, unassociated where the format has it so; 16 bits if the format has them and
///                     `source_bits` > 8 (DPX always), else 8 bits
/// Formats without windows get the display window, padded with zeros. Formats without alpha lose it: colour stays
/// premultiplied, as if over black.
Picture picture_from_linear(const LinearImage& image, const std::filesystem::path& for_file, bool with_alpha,
                            int source_bits);

/// Converts a picture for another file format than it was read from. For the same format it returns the picture as it
/// is. Kept are the main colour layer with its alpha, encoded as picture_from_linear does it (16-bit codes become float
/// in EXR), and metadata that do not describe the old format's storage. Other parts, layers and data channels are
/// dropped. FrameError if the picture holds no colour.
Picture picture_for_format(Picture picture, const std::filesystem::path& for_file);

using Attribute = std::pair<std::string, std::variant<double, std::string>>;

/// Writes a float32 ZIP EXR with named channels, atomically: a displacement map, an STMap or a slice of a field.
/// interleaved: data.area() * channel_names.size() values. FrameError.
void write_float_exr(const std::filesystem::path& path, const PixelWindow& data, const PixelWindow& display,
                     std::span<const std::string> channel_names, std::span<const float> interleaved,
                     std::span<const Attribute> attributes = {});

/// Configures OpenImageIO and OpenEXR for a pipeline of `threads` workers that read and write several frames at once.
/// Must be called once, before any file is opened.
void set_image_threads(int threads);

}  // namespace eikonal
