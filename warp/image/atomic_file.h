/// Files that appear under their name only when they are whole.
///
/// A writer fills a hidden temporary file in the folder of the final one, `.plate.0001.eikonal-HOST-PID-N.exr`. The
/// true extension stands at the end, so format writers choose the right format. No frame pattern finds the temporary
/// file. A rename commits it. If the write ends in any other way, including an exception, the temporary file is
/// removed. A run that is killed leaves temporary files behind. The next run that writes into the same folder removes
/// those of this host whose process is gone.
///
/// Failures: FrameError with the final file's name and the system's reason. All functions are thread-safe.
#pragma once

#include <filesystem>
#include <string_view>

namespace eikonal {

/// One file while it is written. It can be moved, so a writer can own it for a whole movie.
class AtomicFile {
  public:
    /// Checks that the folder exists and that `final_path` is free or a regular file. Removes stale temporary files of
    /// the folder, once for each process and folder. Picks the temporary name. Creates nothing.
    explicit AtomicFile(std::filesystem::path final_path);
    AtomicFile(AtomicFile&& other) noexcept;
    AtomicFile& operator=(AtomicFile&& other) noexcept;
    /// Removes the temporary file if it was not committed.
    ~AtomicFile();

    const std::filesystem::path& temporary() const { return temporary_; }

    /// Renames the temporary file, which must be closed, to the final name. It replaces a file of that name. FrameError
    /// if the temporary file is missing, is empty (a full disk) or cannot be renamed.
    void commit();

  private:
    void discard() noexcept;

    std::filesystem::path final_;
    std::filesystem::path temporary_;  ///< empty once committed or moved from
};

/// Writes `text` as a whole file (reports, tables). FrameError.
void write_text_file(const std::filesystem::path& path, std::string_view text);

/// Removes the temporary files in `folder` that processes of this host left which no longer run. Returns how many.
int remove_stale_temporaries(const std::filesystem::path& folder);

}  // namespace eikonal
