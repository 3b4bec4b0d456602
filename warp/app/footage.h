/// INPUT and OUTPUT as the user names them: one image, a numbered sequence, or a movie.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "warp/image/movie_reader.h"
#include "warp/image/picture.h"
#include "warp/image/sequence.h"

namespace eikonal {

enum class FootageKind { Still, Sequence, Movie };

/// The kind of footage that a path names. It depends on the spelling of the path alone.
FootageKind footage_kind(const std::filesystem::path& path);

/// Footage that exists: its kind, its frames and the properties of its first picture.
struct Footage {
    FootageKind kind = FootageKind::Still;
    FilePattern files;           ///< the files of a still or a sequence
    std::vector<int> frames;     ///< ascending; empty for a still, and for a movie whose container states no length
    bool count_is_exact = true;  ///< of a movie: whether the number of frames is exact; else it is estimated
    PixelWindow display;         ///< display window of the first readable frame among those wanted
    double pixel_aspect = 1;
    std::optional<Rational> fps;  ///< as stored
    int source_bits = 8;          ///< bits of a colour channel: 8 … 16 integer, 16 half, 32 float
    int channels = 4;             ///< number of channels of all parts
    bool has_alpha = false;
    std::vector<std::string> notes;  ///< what the user should know (rotation, interlace)
};

/// Looks for footage and examines its files. `wanted`: the frames that will be read; empty: all that exist. `still`:
/// the frame number of a still if none is wanted. FrameError (names the frame): no file found, or unreadable.
/// UserError: a folder, or an empty name.
Footage find_footage(const std::filesystem::path& path, const std::vector<int>& wanted, int still);

/// The union of the pixels of all existing frames, counted from the display window's corner. A picture has the pixels
/// of its data window, which may include overscan. Reads the header of every file. A file that cannot be read counts as
/// its display window.
PixelWindow pixels_of(const Footage& footage);

/// The header of the first of `frames` (at least one) whose file can be read. FrameError, which names the first frame,
/// if none can be read.
Picture first_header(const FilePattern& files, const std::vector<int>& frames);

/// The frame numbers that are missing between the first and the last, if the sequence has its usual step.
std::vector<int> missing_frames(const std::vector<int>& frames);

/// "1, 3, 5 … 9 (12 in all)": a list of frames for a message.
std::string frame_list(const std::vector<int>& frames);

}  // namespace eikonal
