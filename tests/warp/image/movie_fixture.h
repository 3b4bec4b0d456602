/// What the tests of movies share: a temporary folder, sources made by the program ffmpeg, and a copy of a movie
/// through linear light.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "warp/image/movie_frame.h"
#include "warp/image/movie_reader.h"
#include "warp/image/movie_writer.h"

namespace eikonal {

namespace fs = std::filesystem;

class Movie : public testing::Test {
  protected:
    Movie() {
        std::string pattern = (fs::temp_directory_path() / "eikonal-movie-XXXXXX").string();
        if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
        folder_ = pattern;
    }
    ~Movie() override { fs::remove_all(folder_); }

    fs::path file(const std::string& name) const { return folder_ / name; }

    static std::string output_of(const std::string& command) {
        std::string text;
        FILE* pipe = popen(command.c_str(), "r");
        std::array<char, 4096> block;
        for (std::size_t n; pipe && (n = fread(block.data(), 1, block.size(), pipe)) > 0;) text.append(block.data(), n);
        EXPECT_TRUE(pipe && pclose(pipe) == 0) << command;
        return text;
    }
    /// ffmpeg ARGUMENTS name
    fs::path make(const std::string& arguments, const std::string& name) const {
        output_of("ffmpeg -nostdin -v error -y " + arguments + " '" + file(name).string() + "' 2>&1");
        return file(name);
    }
    fs::path test_picture(const std::string& options, const std::string& name, int frames = 10,
                          const std::string& size = "96x64") const {
        return make(
            "-f lavfi -i testsrc2=size=" + size + ":rate=24 -frames:v " + std::to_string(frames) + " " + options, name);
    }
    static std::string probe(const fs::path& path, const std::string& what) {
        return output_of("ffprobe -v error " + what + " '" + path.string() + "'");
    }
    static std::string stream_md5(const fs::path& path, const std::string& map) {
        return output_of("ffmpeg -nostdin -v error -i '" + path.string() + "' -map " + map + " -c copy -f md5 -");
    }
    static std::string picture_md5(const fs::path& path) {
        return output_of("ffmpeg -nostdin -v error -i '" + path.string() + "' -map 0:v -f md5 -");
    }
    static std::string bytes(const fs::path& path) {
        std::ifstream in(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    std::vector<std::string> left_over() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename());
        return names;
    }

    /// Copies a movie through linear light with nothing moved, and returns its warnings.
    std::vector<std::string> pass_through(const fs::path& from, const fs::path& to, MovieSettings settings = {}) const {
        std::vector<std::string> warnings;
        settings.warn = [&](const std::string& line) { warnings.push_back(line); };
        const std::vector<int> chosen = settings.frames;
        MovieReader reader(from);
        MovieWriter writer(to, reader, settings);
        MovieFrame frame;
        while (reader.next(frame)) {
            if (!chosen.empty() && std::find(chosen.begin(), chosen.end(), frame.number) == chosen.end()) continue;
            const LinearImage image = load_frame(frame);
            store_frame(frame, image, std::vector<std::uint8_t>(image.data.area(), 0));
            writer.write(frame);
        }
        writer.finish();
        return warnings;
    }

    template <class Action>
    static std::string message_of(const Action& action) {
        try {
            action();
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return "";
    }

    fs::path folder_;
};

inline std::vector<std::int64_t> time_stamps(const fs::path& path) {
    MovieReader reader(path);
    std::vector<std::int64_t> result;
    MovieFrame frame;
    while (reader.next(frame)) result.push_back(frame.pts);
    return result;
}

}  // namespace eikonal
