/// The files that a run writes: OUTPUT, what lies beside it, the report. Checked as a whole before anything runs.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "warp/image/sequence.h"
#include "warp/pixels/linear_image.h"

namespace eikonal {

enum class OutputKind {
    Pictures,  ///< one a frame, in any image format, or a movie
    Maps,      ///< one EXR a frame
    Report,    ///< one file a run
};

/// Files that belong to one option, read or written.
struct NamedFiles {
    std::string option;  ///< how the user named them: "-o", "--depth", "the input"
    FilePattern files;
    bool single = false;  ///< one file whatever its name looks like: a movie, a report

    std::filesystem::path at(int frame) const { return single ? files.text() : files.at(frame); }
};

/// How many frames a movie is to have.
struct AskedFrames {
    std::size_t count = 0;       ///< 0: not known
    bool exact = true;           ///< else an estimate from the input's length
    bool may_lack_some = false;  ///< bad ones are skipped
};

class Outputs {
  public:
    /// UserError: no file name, a format that cannot be written or cannot hold this, a folder that is not there,
    /// something at that name that is not a file.
    void add(const std::string& option, const std::filesystem::path& path, OutputKind kind);

    /// UserError: one file for many frames; an output that is an input, or a frame of it; two outputs that are one
    /// file.
    void check(const std::vector<int>& frames, const std::vector<NamedFiles>& inputs) const;

    /// Takes from `frames` those whose files are all there and whole, tells on stderr that they are kept, and returns
    /// how many they are. Damaged files are told, too: their frames are to be made anew. UserError: a whole picture of
    /// another size than `display`, which may be precious.
    std::size_t keep_finished(std::vector<int>& frames, const PixelWindow& display, const std::stop_token& stop) const;
    /// Whether the movie under -o is there and whole, which is told on stderr as above. UserError: another size, or
    /// another number of frames than `asked`.
    bool keep_movie(const PixelWindow& display, const AskedFrames& asked) const;
    /// The files of an option, or null.
    const NamedFiles* find(const std::string& option) const;

  private:
    struct Output : NamedFiles {
        OutputKind kind;
    };
    std::vector<Output> outputs_;
};

}  // namespace eikonal
