#!/usr/bin/env bash
# Makes the pictures of the paper again, into out/: samples/figures.sh 6, or 7. Needs a build (.ci/setup).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mkdir -p out
warp() { build/warp/eikonal warp "$@" --overwrite --progress none; }
palette() { ffmpeg -v error -y -i "$1" -vf 'split[a][b];[a]palettegen[p];[b][p]paletteuse=dither=none' "$2" && rm "$1"; }

case "${1:-}" in
6) # the plate; the paper's single table; the exact table
    plate=samples/checker.png
    warp "$plate" -o out/fig6-table.png --scene samples/fig6.toml --model table
    warp "$plate" -o out/fig6-spectral.png --scene samples/fig6.toml --model spectral
    oiiotool "$plate" out/fig6-table.png out/fig6-spectral.png --mosaic:pad=4 3x1 -o out/fig6.all.png
    palette out/fig6.all.png out/fig6.png
    echo "out/fig6.png: the plate, model table, model spectral"
    ;;
7) # three views: the plates that the tracer renders; the same through hot air
    build/reference/eikonal-trace render samples/fig7.toml --straight -o 'out/fig7-plate.####.exr' --frames 1,25,49 --overwrite 2>/dev/null
    warp 'out/fig7-plate.####.exr' -o 'out/fig7-air.####.exr' --scene samples/fig7.toml --depth :Z
    pictures=()
    for row in plate air; do
        for frame in 0001 0025 0049; do pictures+=("out/fig7-$row.$frame.exr" --ch R,G,B --colorconvert linear sRGB); done
    done
    oiiotool "${pictures[@]}" --mosaic:pad=4 3x2 -d uint8 -o out/fig7.all.png
    palette out/fig7.all.png out/fig7.png
    echo "out/fig7.png: the plates from three viewpoints, and the same through hot air"
    ;;
*)
    echo "usage: samples/figures.sh 6|7" >&2
    exit 2
    ;;
esac
