#include "warp/app/outputs.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <set>

#include "noise/base/error.h"
#include "warp/displace/grid/model.h"
#include "warp/image/movie_writer.h"
#include "warp/image/picture.h"

namespace eikonal {
namespace fs = std::filesystem;
namespace {

/// A path that is the same for all names of one file, whether or not the file exists. Links are followed.
fs::path identity(const fs::path& file) {
    std::error_code ignored;
    const auto path = fs::weakly_canonical(fs::absolute(file), ignored);
    return ignored ? fs::absolute(file).lexically_normal() : path;
}

/// "plate.####.exr" from "plate.exr".
std::string numbered(const fs::path& path, const std::string& extension) {
    return (path.parent_path() / (path.stem().string() + ".####" + extension)).string();
}

void check_format(const std::string& option, const fs::path& path, OutputKind kind) {
    if (kind == OutputKind::Report) return;
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (kind == OutputKind::Maps) {
        if (is_movie(path))
            throw UserError(fmt::format("{}: '{}' is a movie, which cannot hold float maps; write a sequence like '{}'",
                                        option, path.string(), numbered(path, ".exr")));
        if (extension != ".exr")
            throw UserError(fmt::format("{}: '{}' must be an EXR, whose floats hold the map exactly; name it '{}'",
                                        option, path.string(), fs::path(path).replace_extension(".exr").string()));
    } else if (is_movie(path) ? !is_movie_name(path) : !can_write_picture(path)) {
        throw UserError(fmt::format(
            "{}: '{}': no format that can be written has the extension '{}'; use .exr, .png, .tif, .jpg, .dpx, "
            ".mp4, .mov, .mkv, .avi or .webm",
            option, path.string(), extension));
    }
}

constexpr const char* kMakeAnew = "--overwrite makes it anew, another name keeps it";

/// The reason why a whole file of size `found` is not the one asked for; empty if it may be.
std::string other_size(const std::string& option, const fs::path& file, const PixelWindow& found,
                       const PixelWindow& wanted) {
    if (found.width == wanted.width && found.height == wanted.height) return {};
    return fmt::format("{}: '{}' is already there with {} x {} pixels, not the {} x {} of this shot; {}", option,
                       file.string(), found.width, found.height, wanted.width, wanted.height, kMakeAnew);
}

/// How many frames more or fewer a movie may have than asked for.
std::int64_t slack(std::int64_t frames, bool exact) {
    return exact ? 0 : 1 + frames / 50;
}

}  // namespace

void Outputs::add(const std::string& option, const fs::path& path, OutputKind kind) {
    if (path.filename().empty() || path.filename() == "." || path.filename() == "..")
        throw UserError(fmt::format("{}: '{}' is no file name", option, path.string()));
    std::error_code ignored;
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, ignored))
        throw UserError(fmt::format("{}: the folder '{}' does not exist; make it first", option, folder.string()));
    if (fs::is_directory(path, ignored))
        throw UserError(fmt::format("{}: '{}' is a folder; name a file in it", option, path.string()));
    if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
        throw UserError(fmt::format("{}: '{}' is not a regular file; name one in a folder", option, path.string()));
    check_format(option, path, kind);
    const bool single = kind == OutputKind::Report || (kind == OutputKind::Pictures && is_movie(path));
    outputs_.push_back({{option, FilePattern::parse(path), single}, kind});
}

void Outputs::check(const std::vector<int>& frames, const std::vector<NamedFiles>& inputs) const {
    for (const Output& output : outputs_)
        if (!output.single && !output.files.is_sequence() && frames.size() > 1)
            throw UserError(
                fmt::format("{}: '{}' names one file for {} frames; put #### where the frame number goes, e.g. '{}'",
                            output.option, output.files.text().string(), frames.size(),
                            numbered(output.files.text(), output.files.text().extension().string())));
    std::map<fs::path, std::string> taken;
    const auto claim = [&](const fs::path& file, const std::string& who, bool written) {
        const auto [other, fresh] = taken.emplace(identity(file), who);
        if (fresh || !written || other->second == who) return;
        throw UserError(fmt::format("{} and {} are the same file, '{}'; give the output another name", other->second,
                                    who, file.string()));
    };
    const auto claim_all = [&](const NamedFiles& named, bool written) {
        if (named.single || !named.files.is_sequence()) {
            claim(named.files.text(), named.option, written);
            return;
        }
        std::set<int> numbers(frames.begin(), frames.end());
        if (!written) {  // Existing frames that are not asked for must not be lost either.
            const std::vector<int> all = named.files.find_frames();
            numbers.insert(all.begin(), all.end());
        }
        for (const int number : numbers) claim(named.at(number), named.option, written);
    };
    for (const NamedFiles& input : inputs) claim_all(input, false);
    for (const Output& output : outputs_) claim_all(output, true);
}

std::size_t Outputs::keep_finished(std::vector<int>& frames, const PixelWindow& display,
                                   const std::stop_token& stop) const {
    struct Found {
        bool finished = true;
        fs::path damaged;  ///< the first damaged file
        std::string refusal;
    };
    const auto look = [&](int frame) {
        Found found;
        for (const Output& output : outputs_) {
            if (output.kind == OutputKind::Report) continue;
            const fs::path file = output.at(frame);
            std::error_code ignored;
            const bool there = fs::is_regular_file(file, ignored);
            found.finished = found.finished && there;
            if (!there) continue;
            try {
                const PixelWindow size = display_window(read_picture_ends(file).parts.front());
                if (found.refusal.empty()) found.refusal = other_size(output.option, file, size, display);
            } catch (const FrameError&) {
                found.finished = false;
                if (found.damaged.empty()) found.damaged = file;
            }
        }
        return found;
    };
    std::vector<Found> found(frames.size());
    tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t i) {
        check_stop(stop);
        found[i] = look(frames[i]);
    });
    for (const Found& each : found)
        if (!each.refusal.empty()) throw UserError(each.refusal);
    std::vector<int> missing;
    std::vector<fs::path> damaged;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        if (!found[i].finished) missing.push_back(frames[i]);
        if (!found[i].damaged.empty()) damaged.push_back(found[i].damaged);
    }
    const std::size_t kept = frames.size() - missing.size();
    frames = std::move(missing);
    if (kept > 0)
        fmt::print(stderr, "eikonal: {} frame{} already there and kept; --overwrite makes {} anew\n", kept,
                   kept == 1 ? " is" : "s are", kept == 1 ? "it" : "them");
    if (!damaged.empty())
        fmt::print(stderr, "eikonal: '{}'{} damaged and made anew\n", damaged.front().string(),
                   damaged.size() == 1 ? " is" : fmt::format(" and {} more are", damaged.size() - 1));
    return kept;
}

bool Outputs::keep_movie(const PixelWindow& display, const AskedFrames& asked) const {
    const NamedFiles& output = *find("-o");
    const fs::path& file = output.files.text();
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return false;
    std::optional<std::int64_t> frames;
    bool estimated = false;
    PixelWindow size;
    try {
        const MovieReader reader(file);
        size = {0, 0, reader.format().width, reader.format().height};
        frames = count_frames(file);
        const std::int64_t stated = reader.frame_count().value_or(0);
        if (frames && *frames + slack(stated, reader.count_is_exact()) < stated)
            throw FrameError("it is cut off between two frames");
        if (!frames && stated > 0) {  // a Theora movie states its length only
            frames = stated;
            estimated = true;
        }
    } catch (const FrameError&) {
        fmt::print(stderr, "eikonal: '{}' is damaged and made anew\n", file.string());
        return false;
    }
    if (const std::string refusal = other_size(output.option, file, size, display); !refusal.empty())
        throw UserError(refusal);
    const std::string held =
        frames ? fmt::format("{}{} frame{}", estimated ? "about " : "", *frames, *frames == 1 ? "" : "s") : "";
    const auto wanted = static_cast<std::int64_t>(asked.count);
    const std::int64_t more = slack(wanted, asked.exact && !estimated);
    if (frames && wanted > 0 && (*frames > wanted + more || (*frames + more < wanted && !asked.may_lack_some)))
        throw UserError(fmt::format("{}: '{}' is already there with {}, not the {} that are asked for; {}",
                                    output.option, file.string(), held, wanted, kMakeAnew));
    fmt::print(stderr, "eikonal: '{}' is already there and kept{}; --overwrite makes it anew\n", file.string(),
               frames ? " (" + held + ")" : "");
    return true;
}

const NamedFiles* Outputs::find(const std::string& option) const {
    for (const Output& output : outputs_)
        if (output.option == option) return &output;
    return nullptr;
}

}  // namespace eikonal
