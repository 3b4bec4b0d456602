// How the tests of the programs run them: processes, folders, pictures.
#include "tests/programs/program_run.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

namespace program_test {
namespace {

using Clock = std::chrono::steady_clock;

fs::path fresh_folder() {
    std::string name = (fs::temp_directory_path() / "eikonal-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    return name;
}

std::string slurp(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// The file for a process's messages. It is beside the folder, so that the folder holds the program's files only.
fs::path messages(const fs::path& folder, const char* which, pid_t process) {
    return folder.string() + "." + std::to_string(process) + which;
}

pid_t launch(const fs::path& folder, const Words& words, long limit) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const pid_t process = fork();
    if (process != 0) return process;
    const int out = open(messages(folder, ".out", getpid()).c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    const int err = open(messages(folder, ".err", getpid()).c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    if (chdir(folder.c_str()) != 0) _exit(126);
    if (limit > 0) {
        const rlimit size{static_cast<rlim_t>(limit), static_cast<rlim_t>(limit)};
        setrlimit(RLIMIT_FSIZE, &size);
    }
    execvp(arguments[0], arguments.data());
    _exit(127);
}

}  // namespace

Words Ended::lines() const {
    Words lines;
    std::istringstream stream(err);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

int Pixels::channel(const std::string& name) const {
    const auto found = std::find(spec.channelnames.begin(), spec.channelnames.end(), name);
    if (found == spec.channelnames.end()) throw std::runtime_error("no channel " + name);
    return static_cast<int>(found - spec.channelnames.begin());
}

double rms(const Pixels& map) {
    double sum = 0;
    for (const float v : map.values) sum += double{v} * v;
    return std::sqrt(2 * sum / static_cast<double>(map.values.size()));
}

Program::Program() : folder_(fresh_folder()) {}

Program::~Program() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

pid_t Program::start(Words words, long limit) const {
    words.insert(words.begin(), EIKONAL_PROGRAM);
    if (std::find(words.begin(), words.end(), "--progress") == words.end() && words.size() > 2 && words[1] != "presets")
        words.insert(words.begin() + 2, {"--progress", "none"});
    return launch(folder_, words, limit);
}

Ended Program::finish(pid_t process) const {
    Ended ended;
    const auto begin = Clock::now();
    int status = 0;
    rusage usage{};
    wait4(process, &status, 0, &usage);
    ended.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    ended.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    ended.peak_kb = usage.ru_maxrss;
    for (const auto& [which, text] : {std::pair{".out", &ended.out}, std::pair{".err", &ended.err}}) {
        const fs::path file = messages(folder_, which, process);
        *text = slurp(file);
        fs::remove(file);
    }
    return ended;
}

Ended Program::run(Words words, long limit) const {
    return finish(start(std::move(words), limit));
}
pid_t Program::start_tool(Words words) const {
    return launch(folder_, words, 0);
}

Ended Program::tool(Words words) const {
    return finish(start_tool(std::move(words)));
}

void Program::refused(const Ended& ended, int status, std::initializer_list<std::string> fragments) const {
    EXPECT_EQ(ended.status, status) << ended.err;
    const Words lines = ended.lines();
    EXPECT_EQ(lines.size(), 1u) << ended.err;
    EXPECT_TRUE(ended.err.starts_with("eikonal: ")) << ended.err;
    for (const std::string& fragment : fragments)
        EXPECT_NE(ended.err.find(fragment), std::string::npos) << "no \"" << fragment << "\" in: " << ended.err;
    EXPECT_EQ(ended.out, "");
}

void Program::silent(const Ended& ended) const {
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(ended.err, "");
}

void Program::silent_but_for_folding(const Ended& ended) const {
    EXPECT_EQ(ended.status, 0) << ended.err;
    for (const std::string& line : ended.lines())
        EXPECT_NE(line.find("rays fold, and the picture tears"), std::string::npos) << line;
}

std::string Program::bytes(const std::string& name) const {
    return slurp(path(name));
}

void Program::write_text(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
}

Words Program::names() const {
    Words names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

void Program::paint(const std::string& name, OIIO::ImageSpec spec, const Colour& colour) const {
    std::vector<float> values;
    for (int y = 0; y < spec.height; ++y)
        for (int x = 0; x < spec.width; ++x)
            for (int c = 0; c < spec.nchannels; ++c) values.push_back(colour(x, y, c));
    const auto output = OIIO::ImageOutput::create(path(name).string());
    ASSERT_TRUE(output && output->open(path(name).string(), spec)) << name;
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()) && output->close()) << output->geterror();
}

void Program::plate(const std::string& name) const {
    const bool exr = name.ends_with(".exr");
    const auto type = exr ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::UINT8;
    paint(name, OIIO::ImageSpec(kWidth, kHeight, 3, type), [](int x, int y, int c) {
        return static_cast<float>(0.5 + 0.2 * std::sin(0.35 * x + c) + 0.2 * std::cos(0.3 * y - 2 * c));
    });
}

void Program::depth(const std::string& name, const std::function<float(int x, int y)>& metres, int width) const {
    OIIO::ImageSpec spec(width, kHeight, 1, OIIO::TypeDesc::FLOAT);
    spec.channelnames = {"Z"};
    paint(name, spec, [&](int x, int y, int) { return metres(x, y); });
}

Pixels Program::read(const std::string& name, int part) const {
    Pixels pixels;
    OIIO::ImageSpec hints;
    hints["oiio:UnassociatedAlpha"] = 1;
    const auto input = OIIO::ImageInput::open(path(name).string(), &hints);
    if (!input || !input->seek_subimage(part, 0)) {
        ADD_FAILURE() << "cannot read " << name << ": " << OIIO::geterror();
        return pixels;
    }
    pixels.spec = input->spec();
    pixels.values.resize(pixels.spec.image_pixels() * static_cast<std::size_t>(pixels.spec.nchannels));
    EXPECT_TRUE(input->read_image(part, 0, 0, pixels.spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.values.data()))
        << name;
    return pixels;
}

void Program::air(const std::string& more) const {
    write_text("air.toml", R"(
[camera]
resolution = [64, 48]
horizontal_fov = 5
[[medium]]
type = "turbulence"
form = "lattice"
cn2 = 2e-10
outer_scale = 1
inner_scale = 0.3
velocity = [0.2, 0.3, 0]
lattice = [16, 16, 16, 8]
period = [4, 4, 40, 4]
)" + more + "\n[plate]\ndistance = 30\nfar = 40\n");
}

}  // namespace program_test
