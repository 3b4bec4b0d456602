/// The files that a run writes: OUTPUT and what lies beside it. Checked as a whole before anything runs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "warp/image/sequence.h"

namespace eikonal {

/// One of the outputs: -o, --stmap, --displacement.
struct Output {
    std::string option;  ///< how the user named it
    FilePattern files;
    bool movie = false;

    std::filesystem::path at(int frame) const { return files.at(frame); }
};

class Outputs {
  public:
    /// Adds an output. `movies`: whether it may be a movie. UserError: a movie where none can be, a folder that is not there.
    void add(const std::string& option, const std::filesystem::path& path, bool movies);

    /// UserError: one file for many frames; an output that is an input; two outputs that are the same file.
    void check(const std::vector<int>& frames, const std::vector<FilePattern>& inputs) const;

    /// Whether all files of a frame are there (they appear only when whole).
    bool finished(int frame) const;
    const Output* find(const std::string& option) const;
    const std::vector<Output>& all() const { return outputs_; }

  private:
    std::vector<Output> outputs_;
};

}  // namespace eikonal
