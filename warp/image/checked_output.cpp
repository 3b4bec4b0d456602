#include "warp/image/checked_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "noise/base/error.h"

namespace eikonal {
namespace {
constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
}

CheckedOutput::CheckedOutput(const std::filesystem::path& path, std::filesystem::path shown)
    : IOProxy(path.string(), IOProxy::Write),
      shown_(std::move(shown)),
      file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
    if (file_ < 0) throw FrameError(fmt::format("cannot write '{}': {}", shown_.string(), std::strerror(errno)));
    buffer_.reserve(kBufferBytes);
}

CheckedOutput::~CheckedOutput() {
    if (file_ >= 0) ::close(file_);
}

void CheckedOutput::finish() {
    drain();
    if (::close(std::exchange(file_, -1)) != 0 && failure_ == 0) failure_ = errno;
    if (failure_ != 0) throw FrameError(fmt::format("cannot write '{}': {}", shown_.string(), std::strerror(failure_)));
}

bool CheckedOutput::store(const void* bytes, size_t size, int64_t offset) {
    const char* from = static_cast<const char*>(bytes);
    while (size > 0 && failure_ == 0) {
        const ssize_t written = ::pwrite(file_, from, size, offset);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) {
            failure_ = written < 0 ? errno : ENOSPC;
            break;
        }
        from += written;
        offset += written;
        size -= static_cast<size_t>(written);
    }
    return failure_ == 0;
}

bool CheckedOutput::drain() {
    const bool good = store(buffer_.data(), buffer_.size(), buffer_at_);
    buffer_at_ += static_cast<int64_t>(buffer_.size());
    buffer_.clear();
    return good;
}

bool CheckedOutput::seek(int64_t offset) {
    m_pos = offset;
    return offset >= 0;
}

size_t CheckedOutput::write(const void* bytes, size_t size) {
    const auto end_of_buffer = buffer_at_ + static_cast<int64_t>(buffer_.size());
    if (m_pos != end_of_buffer || buffer_.size() + size > kBufferBytes) {
        if (!drain()) return 0;
        buffer_at_ = m_pos;
    }
    if (size > kBufferBytes) {
        if (!store(bytes, size, m_pos)) return 0;
        buffer_at_ = m_pos + static_cast<int64_t>(size);
    } else {
        const auto* from = static_cast<const std::byte*>(bytes);
        buffer_.insert(buffer_.end(), from, from + size);
    }
    m_pos += static_cast<int64_t>(size);
    size_ = std::max(size_, m_pos);
    return failure_ == 0 ? size : 0;
}

size_t CheckedOutput::pwrite(const void* bytes, size_t size, int64_t offset) {
    if (!drain() || !store(bytes, size, offset)) return 0;
    size_ = std::max(size_, offset + static_cast<int64_t>(size));
    return size;
}

size_t CheckedOutput::size() const {
    return static_cast<size_t>(size_);
}

}  // namespace eikonal
