// Fuzz target of the scene reader. Any text, as a file, as a --set option or as a .chan file, must be read or be
// refused by a UserError of one line. A text that is read must give finite cameras.
//
// Built with -fsanitize=fuzzer and EIKONAL_LIBFUZZER it is driven by libFuzzer. Otherwise its own main feeds it a fixed
// corpus and deterministic mutations of that. Usage: scene_fuzz [runs], or scene_fuzz FILE to replay one input.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "noise/base/error.h"
#include "warp/scene/camera.h"
#include "warp/scene/scene.h"

namespace {

void require(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "scene_fuzz: violated: %s\n", what);
    std::abort();
}

bool finite(const eikonal::Camera& c) {
    const double values[] = {c.position.x, c.position.y, c.position.z, c.right.x,   c.right.y,   c.right.z, c.up.x,
                             c.up.y,       c.up.z,       c.forward.x,  c.forward.y, c.forward.z, c.f_px};
    return std::all_of(std::begin(values), std::end(values), [](double v) { return std::isfinite(v); }) && c.f_px > 0;
}

/// Runs `action`; a UserError is a valid outcome if its message is one line.
template <class F>
void attempt(F action) {
    try {
        action();
    } catch (const eikonal::UserError& error) {
        const std::string_view message = error.what();
        require(!message.empty() && message.find('\n') == message.npos, "messages have one line");
    }
}

const std::string kBase = "[[medium]]\ntype = \"turbulence\"\nfalloff = {length = 2}\nvelocity = [1, 2, 3]\n";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    attempt([&] {
        eikonal::Scene scene = eikonal::parse_scene(text, "scene.toml");
        scene.camera.path.reset();  // not from the disk
        require(finite(eikonal::CameraPath(scene.camera, 1920, 1080).at(1)), "cameras are finite");
    });
    attempt([&] { eikonal::parse_scene(kBase, "scene.toml", {text}); });
    attempt([&] {
        for (const eikonal::ChanKey& key : eikonal::parse_chan(text, "moves.chan"))
            require(std::isfinite(key.orientation.w) && std::isfinite(key.position.x), "keys are finite");
    });
    return 0;
}

#ifndef EIKONAL_LIBFUZZER

#include <fstream>
#include <iterator>

#include "noise/math/random.h"

namespace {

const char* const kCorpus[] = {
    "",
    "medium.0.cn2=1e-13",
    "medium.0.falloff.length=[1, {a = 2}]",
    "medium.1={type = \"surface\"}",
    "a.0.b.0.c=\"x\"",
    "1 0 0 0 0 0 0\n2 1.5 2 -3e2 10 20 30 # end\n",
    "1 0 0 0 0 0 0 40\n10 0 1 2 170 -170 90 50\n",
    "[camera]\nresolution = [640, 480]\nposition = [0, 1, 2]\nlook_at = [0, 1, -5]\nup = [0, 1, 0]\nfocal_length = 50\n"
    "sensor_width = 36\n[time]\nfps = 24\nfirst_frame = 1001\n[optics]\nray_equation = \"paper\"\naperture = 0.1\n",
    "[camera]\nprojection = \"orthographic\"\nwidth = 4\npath = \"a.chan\"\n[plate]\nground = [2, 0.5]\nfar = 1e4\n",
    "[[medium]]\ntype = \"turbulence\"\nseed = 7\nspectrum = \"paper\"\nstrength = 1e-11\nlowest_wavenumber = 2\n"
    "form = \"lattice\"\nlattice = [32, 32, 32, 32]\nperiod = [10, 10, 10, 5]\nfalloff = {origin = [0,0,0], normal = "
    "[0,1,0], length = 2}\n",
    "[[medium]]\ntype = \"surface\"\nsurface_temperature = 305\ndropoff = 0.01\n[[medium]]\ntype = \"blobs\"\n"
    "blob = [{center = [1,2,3], sigma = 0.1, temperature = 900}]\nsource = [{rate = 3, lifetime = 5}]\nwind = {rms = "
    "1}\n",
    "[[medium]]\ntype = \"profile\"\nprofile = \"fish-eye\"\nn0 = 2\nradius = 1\n",
    "[[object]]\nshape = \"mesh\"\nfile = \"a.obj\"\n[[object]]\ntexture = 'b.png'\n[light]\ncolor = [1,1,1]\n"
    "[background]\nimage = \"sky.exr\"\n",
    "a.b.c.\"d=\".e = {f = [1, 2, {g = '''\nx'''}]}\n",
    "x = 1979-05-27T07:32:00Z\ny = [0x1f, 0b1, 1_000, -nan, +inf]\nz = \"\\u00e9\\U0001F600\"\n",
};

// Pieces that a scene is made of, spliced in by mutations.
const char* const kWords[] = {"medium",
                              "type",
                              "=",
                              ".",
                              "[[",
                              "]]",
                              "[",
                              "]",
                              "{",
                              "}",
                              ",",
                              "\n",
                              "\"",
                              "'''",
                              "\"\"\"",
                              "#",
                              "nan",
                              "inf",
                              "-",
                              "1e999",
                              "0",
                              "-1",
                              "1e-320",
                              "99999999999",
                              "true",
                              "\xff",
                              "\xef\xbb\xbf",
                              "\\u0000",
                              "look_at = [0, 1.5, 0]",
                              "up = [0, 0, 0]",
                              "a.a.a.a.a.a.a.a."};

std::string mutated(std::uint64_t run) {
    const eikonal::RandomStream random(1, "scene_fuzz", run);
    std::uint64_t counter = 0;
    const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random.bits(counter++) % n); };
    std::string text = kCorpus[pick(std::size(kCorpus))];
    for (std::size_t edits = 1 + pick(8); edits > 0; --edits) {
        const std::size_t at = pick(text.size() + 1), length = std::min(pick(16), text.size() - at);
        const std::string other = kCorpus[pick(std::size(kCorpus))];
        switch (pick(6)) {
            case 0:
                text.insert(at, kWords[pick(std::size(kWords))]);
                break;
            case 1:
                text.erase(at, length);
                break;
            case 2:
                text.insert(at, 1, static_cast<char>(pick(256)));
                break;
            case 3:
                text.insert(at, other.substr(pick(other.size() + 1)));
                break;
            case 4:
                text.insert(at, text.substr(at, length));
                break;
            default:
                if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1 << pick(8)));
        }
    }
    if (pick(50) == 0) {  // one piece very often
        const std::string word = kWords[pick(std::size(kWords))];
        for (std::size_t n = pick(3000); n > 0; --n) text += word;
    }
    return text;
}

void feed(const std::string& text) {
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

}  // namespace

int main(int argc, char** argv) {
    std::uint64_t runs = 20000;
    if (argc > 1) {
        if (std::ifstream file(argv[1], std::ios::binary); file) {
            feed({std::istreambuf_iterator<char>(file), {}});
            return 0;
        }
        runs = std::strtoull(argv[1], nullptr, 10);
    }
    for (const char* text : kCorpus) feed(text);
    for (std::uint64_t run = 0; run < runs; ++run) feed(mutated(run));
    std::printf("scene_fuzz: %llu inputs\n", static_cast<unsigned long long>(runs + std::size(kCorpus)));
}

#endif
