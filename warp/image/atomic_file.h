/// Files that appear under their name only when they are whole.
///
/// A writer fills a hidden temporary file in the folder of the final one (`.plate.0001.eikonal-HOST-PID-N.exr`, with
/// the true extension at the end, so that format writers choose the right format and no frame pattern finds it) and
/// commits it by a rename. Whatever ends the write before, including an exception, removes the temporary. What a killed
/// run has left is removed by the next run that writes into the same folder: temporaries of this host whose process is
/// gone.
///
/// Failures: FrameError naming the final file and the system's reason. All functions are safe to call from any thread.
#pragma once

#include <filesystem>
#include <string_view>

namespace eikonal {

/// One file in the making. Movable, so that a writer may own it for a whole movie.
class AtomicFile {
  public:
    /// Checks that the folder exists and that `final_path` is free or a regular file, clears stale temporaries of the
    /// folder (once a process and folder), and picks the temporary name; creates nothing.
    explicit AtomicFile(std::filesystem::path final_path);
    AtomicFile(AtomicFile&& other) noexcept;
    AtomicFile& operator=(AtomicFile&& other) noexcept;
    /// Removes the temporary if it was not committed.
    ~AtomicFile();

    const std::filesystem::path& temporary() const { return temporary_; }

    /// Renames the temporary, which must be closed, to the final name, replacing what was there.
    /// FrameError if it is missing or empty (nothing was written: a full disk) or cannot be renamed.
    void commit();

  private:
    void discard() noexcept;

    std::filesystem::path final_;
    std::filesystem::path temporary_;  ///< empty once committed or moved from
};

/// Writes `text` as a whole file (reports, tables). FrameError.
void write_text_file(const std::filesystem::path& path, std::string_view text);

/// Removes the temporaries in `folder` that were left by processes of this host that no longer run; returns how many.
int remove_stale_temporaries(const std::filesystem::path& folder);

}  // namespace eikonal
