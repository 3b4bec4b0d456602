/// A file that remembers every failure while it is written.
///
/// Format libraries ignore errors of their last writes, for example of buffers that a destructor flushes. A full disk
/// can then pass for success. Everything that they write goes through this proxy, and its finish() reports any failure.
#pragma once

#include <OpenImageIO/filesystem.h>

#include <filesystem>
#include <vector>

namespace eikonal {

/// Buffered and seekable. Not thread-safe.
class CheckedOutput final : public OIIO::Filesystem::IOProxy {
  public:
    /// Creates the file. FrameError with the name `shown`, which is the final name.
    CheckedOutput(const std::filesystem::path& path, std::filesystem::path shown);
    CheckedOutput(const CheckedOutput&) = delete;
    CheckedOutput& operator=(const CheckedOutput&) = delete;
    ~CheckedOutput() override;

    /// Writes the buffer and closes the file. FrameError if this or any earlier operation failed.
    void finish();

    const char* proxytype() const override { return "checked"; }
    bool seek(int64_t offset) override;
    size_t write(const void* buffer, size_t size) override;
    size_t pwrite(const void* buffer, size_t size, int64_t offset) override;
    size_t size() const override;

  private:
    bool store(const void* bytes, size_t size, int64_t offset);
    bool drain();

    std::filesystem::path shown_;
    int file_ = -1;
    int failure_ = 0;  ///< errno of the first failure, else 0
    std::vector<std::byte> buffer_;
    int64_t buffer_at_ = 0;  ///< place of the buffer in the file
    int64_t size_ = 0;
};

}  // namespace eikonal
