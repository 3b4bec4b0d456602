/// The files that a run writes: OUTPUT, the files beside it and the report. They are checked together before the run.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "warp/image/sequence.h"
#include "warp/pixels/linear_image.h"

namespace eikonal {

enum class OutputKind {
    Pictures,  ///< one file a frame, in any image format, or a movie
    Maps,      ///< one EXR file a frame
    Report,    ///< one file a run
};

/// Files that belong to one option. They are read or written.
struct NamedFiles {
    std::string option;  ///< what the user called them: "-o", "--depth", "the input"
    FilePattern files;
    bool single = false;  ///< whether the name stands for one file whatever it looks like: a movie, a report

    std::filesystem::path at(int frame) const { return single ? files.text() : files.at(frame); }
};

/// The number of frames that a movie should have.
struct AskedFrames {
    std::size_t count = 0;       ///< 0: unknown
    bool exact = true;           ///< false: estimated from the length of the input
    bool may_lack_some = false;  ///< whether bad frames are skipped
};

class Outputs {
  public:
    /// UserError: no file name, a format that cannot be written or cannot hold this kind, a folder that does not exist,
    /// or something at that name that is not a file.
    void add(const std::string& option, const std::filesystem::path& path, OutputKind kind);

    /// UserError: one file for several frames; an output that is an input or a frame of it; two outputs that are the
    /// same file.
    void check(const std::vector<int>& frames, const std::vector<NamedFiles>& inputs) const;

    /// Removes from `frames` those whose files all exist and are whole. Reports on stderr that they are kept, and
    /// returns their number. Damaged files are reported too; their frames remain to be made. UserError: a whole picture
    /// of another size than `display`, which is not overwritten because it may be of value.
    std::size_t keep_finished(std::vector<int>& frames, const PixelWindow& display, const std::stop_token& stop) const;
    /// Whether the movie under -o exists and is whole, which is reported on stderr as above. UserError: a movie of
    /// another size, or with another number of frames than `asked`.
    bool keep_movie(const PixelWindow& display, const AskedFrames& asked) const;
    /// The files of an option; null if it has none.
    const NamedFiles* find(const std::string& option) const;

  private:
    struct Output : NamedFiles {
        OutputKind kind;
    };
    std::vector<Output> outputs_;
};

}  // namespace eikonal
