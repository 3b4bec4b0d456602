#include "warp/image/atomic_file.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include "noise/base/error.h"

namespace eikonal {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kMark = ".eikonal-";
constexpr std::size_t kLongestName = 255;  ///< bytes of a file name that every common file system allows

/// This host's name, reduced to letters, digits and underscores.
const std::string& host() {
    static const std::string name = [] {
        std::array<char, 65> text{};
        if (gethostname(text.data(), text.size() - 1) != 0) return std::string("host");
        std::string clean(text.data());
        for (char& c : clean)
            if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
        return clean;
    }();
    return name;
}

fs::path temporary_name(const fs::path& final_path) {
    static std::atomic<unsigned> serial{0};
    const std::string tail =
        fmt::format("{}{}-{}-{}{}", kMark, host(), getpid(), serial++, final_path.extension().string());
    std::string stem = final_path.stem().string();
    if (1 + stem.size() + tail.size() > kLongestName) stem.resize(kLongestName - 1 - tail.size());
    return final_path.parent_path() / ("." + stem + tail);
}

/// The process that made the temporary file `name`, or 0 if no process of this host did.
pid_t owner(std::string_view name) {
    const std::size_t mark = name.rfind(kMark);
    if (name.empty() || name.front() != '.' || mark == std::string_view::npos) return 0;
    std::string_view rest = name.substr(mark + kMark.size());  // HOST-PID-N.ext
    const std::string expected = host() + "-";
    if (rest.substr(0, expected.size()) != expected) return 0;
    rest.remove_prefix(expected.size());
    pid_t pid = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), pid);
    const bool whole = error == std::errc{} && end != rest.data() + rest.size() && *end == '-';
    return whole && pid > 0 ? pid : 0;
}

/// Removes stale temporary files when this process first writes into `folder`.
void clear_once(const fs::path& folder) {
    static std::mutex mutex;
    static std::set<fs::path> cleared;
    std::error_code error;
    const fs::path key = fs::canonical(folder, error);
    const std::lock_guard lock(mutex);
    if (!error && cleared.insert(key).second) remove_stale_temporaries(folder);
}

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace

AtomicFile::AtomicFile(fs::path final_path) : final_(std::move(final_path)) {
    if (final_.filename().empty() || final_.filename() == "." || final_.filename() == "..")
        throw FrameError(fmt::format("cannot write '{}': the path names no file", final_.string()));
    std::error_code error;
    const fs::path folder = folder_of(final_);
    const fs::file_status folder_status = fs::status(folder, error);
    if (!fs::is_directory(folder_status))
        throw FrameError(fmt::format("cannot write '{}': the folder '{}' {}; make it first", final_.string(),
                                     folder.string(),
                                     fs::exists(folder_status) ? "is not a folder" : "does not exist"));
    const fs::file_status status = fs::status(final_, error);
    if (fs::exists(status) && !fs::is_regular_file(status))
        throw FrameError(fmt::format("cannot write '{}': it exists and is not a regular file", final_.string()));
    if (access(folder.c_str(), W_OK | X_OK) != 0)
        throw FrameError(
            fmt::format("cannot write '{}': folder '{}': {}", final_.string(), folder.string(), std::strerror(errno)));
    clear_once(folder);
    temporary_ = temporary_name(final_);
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : final_(std::move(other.final_)), temporary_(std::exchange(other.temporary_, {})) {}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
    if (this != &other) {
        discard();
        final_ = std::move(other.final_);
        temporary_ = std::exchange(other.temporary_, {});
    }
    return *this;
}

AtomicFile::~AtomicFile() {
    discard();
}

void AtomicFile::discard() noexcept {
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
    temporary_.clear();
}

void AtomicFile::commit() {
    std::error_code error;
    const auto size = fs::file_size(temporary_, error);
    if (error || size == 0)
        throw FrameError(fmt::format("cannot write '{}': nothing reached the disk; is it full?", final_.string()));
    fs::rename(temporary_, final_, error);
    if (error) throw FrameError(fmt::format("cannot write '{}': {}", final_.string(), error.message()));
    temporary_.clear();
}

void write_text_file(const fs::path& path, std::string_view text) {
    AtomicFile file(path);
    std::FILE* stream = std::fopen(file.temporary().c_str(), "wb");
    bool whole = stream != nullptr && std::fwrite(text.data(), 1, text.size(), stream) == text.size();
    int reason = whole ? 0 : errno;
    if (stream != nullptr && std::fclose(stream) != 0 && whole) {
        whole = false;
        reason = errno;
    }
    if (!whole) throw FrameError(fmt::format("cannot write '{}': {}", path.string(), std::strerror(reason)));
    file.commit();
}

int remove_stale_temporaries(const fs::path& folder) {
    int removed = 0;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        const pid_t pid = owner(entry->path().filename().string());
        if (pid == 0 || pid == getpid() || kill(pid, 0) == 0 || errno != ESRCH) continue;
        if (::unlink(entry->path().c_str()) == 0) ++removed;
    }
    return removed;
}

}  // namespace eikonal
