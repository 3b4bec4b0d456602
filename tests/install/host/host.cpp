// The smallest host: writes the displacement of a frame of a preset as raw floats.
#include <eikonal/eikonal.h>

#include <fstream>

int main(int, char** argv) {
    eikonal::Settings settings;
    settings.preset = argv[1];
    settings.width = 160;
    settings.height = 90;
    const eikonal::Map map = eikonal::Shimmer(settings).map(3);
    std::ofstream file(argv[2], std::ios::binary);
    file.write(reinterpret_cast<const char*>(map.uv.data()), static_cast<std::streamsize>(4 * map.uv.size()));
    return file ? 0 : 1;
}
