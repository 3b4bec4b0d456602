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

/// What kind of footage a path names, by its spelling alone.
FootageKind footage_kind(const std::filesystem::path& path);

/// Footage that exists: its kind, frames and first picture's properties.
struct Footage {
    FootageKind kind = FootageKind::Still;
    FilePattern files;           ///< of a still or a sequence
    std::vector<int> frames;     ///< ascending; empty for a still, and for a movie whose length its container hides
    bool count_is_exact = true;  ///< of a movie's frames; else estimated from its length
    PixelWindow display;         ///< of the first readable frame among those wanted
    double pixel_aspect = 1;
    std::optional<Rational> fps;  ///< as stored
    int source_bits = 8;          ///< of a colour channel: 8 … 16 integer, 16 half, 32 float
    int channels = 4;             ///< of all parts
    bool has_alpha = false;
    std::vector<std::string> notes;  ///< what the user should know (rotation, interlace)
};

/// Looks at the files. `wanted`: the frames that will be read; empty: all there are. `still`: the frame that a still
/// is, if none is wanted. FrameError: none found, unreadable (names the frame). UserError: a folder, an empty name.
Footage find_footage(const std::filesystem::path& path, const std::vector<int>& wanted, int still);

/// The pixels that any frame there is has, overscan included, from the display window's corner: of pictures, their data
/// windows. Reads the header of every file; what cannot be read counts as the display window.
PixelWindow pixels_of(const Footage& footage);

/// The header of the first of `frames` (at least one) whose file can be read; if none can, FrameError names the first.
Picture first_header(const FilePattern& files, const std::vector<int>& frames);

/// A sequence's numbers that are missing between its first and last, given its usual step.
std::vector<int> missing_frames(const std::vector<int>& frames);

/// "1, 3, 5 … 9 (12 in all)": a list of frames for a message.
std::string frame_list(const std::vector<int>& frames);

}  // namespace eikonal
