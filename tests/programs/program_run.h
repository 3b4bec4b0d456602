/// Black-box tests of `eikonal`, the part that all program_*_test.cpp share. It runs the real program in a folder of
/// its own, which is removed afterwards, and examines exit status, messages and files.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

namespace program_test {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// How a run ended.
struct Ended {
    int status = 0;  ///< exit status; -N if signal N killed it
    std::string out, err;
    double seconds = 0;
    long peak_kb = 0;  ///< most memory it held

    /// Lines of stderr.
    Words lines() const;
};

/// A picture as floats, whatever its file stores.
struct Pixels {
    OIIO::ImageSpec spec;
    std::vector<float> values;  ///< interleaved

    float at(int x, int y, int c) const {
        return values[static_cast<std::size_t>((y * spec.width + x) * spec.nchannels + c)];
    }
    int channel(const std::string& name) const;
};

/// A map's u, v at a pixel, and its rms over a picture.
double rms(const Pixels& map);

inline constexpr int kWidth = 64, kHeight = 48;

class Program : public testing::Test {
  protected:
    Program();
    ~Program() override;

    /// Runs `eikonal WORDS --progress none` in the folder. `limit`: greatest size of a file it may write [bytes].
    Ended run(Words words, long limit = 0) const;
    /// Starts it; for signals. To be ended by finish().
    pid_t start(Words words, long limit = 0) const;
    Ended finish(pid_t process) const;
    /// The same for other tools, given with their name.
    Ended tool(Words words) const;
    pid_t start_tool(Words words) const;

    /// Expects this status and exactly one line on stderr, which begins with "eikonal: " and has all the fragments.
    void refused(const Ended& ended, int status, std::initializer_list<std::string> fragments) const;
    /// Expects success without any output.
    void silent(const Ended& ended) const;
    /// Expects success, and no warning but that rays fold. Small pictures that are moved by pixels always have that
    /// one.
    void silent_but_for_folding(const Ended& ended) const;

    fs::path path(const std::string& name) const { return folder_ / name; }
    std::string bytes(const std::string& name) const;
    void write_text(const std::string& name, const std::string& text) const;
    /// All names in the folder, sorted, hidden ones too.
    Words names() const;

    using Colour = std::function<float(int x, int y, int channel)>;
    /// A picture of kWidth x kHeight, or as `spec` says: colour(x, y, c), x and y within the data window.
    void paint(const std::string& name, OIIO::ImageSpec spec, const Colour& colour) const;
    /// A smooth colourful picture; 3 channels in the format's usual type.
    void plate(const std::string& name) const;
    /// A float EXR of one channel Z.
    void depth(const std::string& name, const std::function<float(int x, int y)>& metres, int width = kWidth) const;
    Pixels read(const std::string& name, int part = 0) const;

    /// A small lattice scene "air.toml": quick and strong.
    void air(const std::string& more = "") const;

  private:
    fs::path folder_;
};

}  // namespace program_test
