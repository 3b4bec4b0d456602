/// A file being written whose every failure is remembered.
///
/// Format libraries drop errors of their last writes (buffers flushed in destructors), so a full disk can pass for
/// success. Everything they write goes through this proxy, whose finish() tells the truth.
#pragma once

#include <OpenImageIO/filesystem.h>

#include <filesystem>
#include <vector>

namespace eikonal {

/// Buffered and seekable. One thread at a time.
class CheckedOutput final : public OIIO::Filesystem::IOProxy {
  public:
    /// Creates the file. FrameError naming `shown` (the final name).
    CheckedOutput(const std::filesystem::path& path, std::filesystem::path shown);
    CheckedOutput(const CheckedOutput&) = delete;
    CheckedOutput& operator=(const CheckedOutput&) = delete;
    ~CheckedOutput() override;

    /// Writes what is buffered and closes. FrameError if this or anything before it failed.
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
    int failure_ = 0;  ///< errno of the first failure
    std::vector<std::byte> buffer_;
    int64_t buffer_at_ = 0;  ///< where in the file the buffer belongs
    int64_t size_ = 0;
};

}  // namespace eikonal
