#!/usr/bin/env bash
# Makes the pictures of the paper again, and a mirage, into out/: samples/figures.sh 2|5|6|7|mirage. Needs a build
# (.ci/setup), in build/ or where BUILD says.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mkdir -p out
build=${BUILD:-build}
warp() { "$build/warp/eikonal" warp "$@" --overwrite --progress none; }
trace() { "$build/reference/eikonal-trace" "$@" 2>/dev/null; }
palette() { ffmpeg -v error -y -i "$1" -vf 'split[a][b];[a]palettegen[p];[b][p]paletteuse=dither=none' "$2" && rm "$1"; }
display=(--ch R,G,B --colorconvert linear sRGB -d uint8)

case "${1:-}" in
2) # two fans of rays over a heated surface: large and small dropoff
    plots=()
    for dropoff in 0.1 0.002; do
        plots+=("set title 'dropoff $dropoff m'")
        curves=()
        for mrad in 2 3 4 5 6 7 8 9; do
            file=out/fig2-$dropoff-$mrad.csv
            trace path samples/fig2.toml --set medium.0.dropoff=$dropoff --origin 0,0.25,0 \
                --direction "0,-0.00$mrad,-1" --length 120 --integrator rk4 --step 0.05 -o "$file"
            curves+=("'$file' every ::1 using (-\$4):(\$3 < 0 || below ? (below = 1, 1/0) : 100*\$3) with lines lw 1.5 lc rgb '#1f5fa8'")
        done
        plots+=("plot below = 0, $(printf '%s, ' "${curves[@]:0:7}" | sed 's/, $//; s/, '\''/, below = 0, '\''/g'), below = 0, ${curves[7]}")
    done
    {
        echo "set datafile separator ','"
        echo "set terminal pngcairo size 840,560 font 'sans,11'; set output 'out/fig2.all.png'"
        echo "set multiplot layout 2,1; unset key; set xrange [0:120]; set yrange [0:50]; set ylabel 'height [cm]'"
        echo "set xlabel 'distance [m]'; set style fill solid; set grid"
        printf '%s\n' "${plots[@]}"
    } | gnuplot
    palette out/fig2.all.png out/fig2.png
    echo "out/fig2.png: fans of rays over a heated surface, large dropoff above, small below"
    ;;
5) # three frames: hot blobs from a line source
    warp samples/checker.png -o 'out/fig5.####.png' --scene samples/fig5.toml --frames 1,25,49
    oiiotool out/fig5.{0001,0025,0049}.png --mosaic:pad=4 3x1 -o out/fig5.all.png
    palette out/fig5.all.png out/fig5.png
    echo "out/fig5.png: three frames, a second apart"
    ;;
6) # the plate; the paper's single table; the exact table
    plate=samples/checker.png
    warp "$plate" -o out/fig6-table.png --scene samples/fig6.toml --model table
    warp "$plate" -o out/fig6-spectral.png --scene samples/fig6.toml --model spectral
    oiiotool "$plate" out/fig6-table.png out/fig6-spectral.png --mosaic:pad=4 3x1 -o out/fig6.all.png
    palette out/fig6.all.png out/fig6.png
    echo "out/fig6.png: the plate, model table, model spectral"
    ;;
7) # three views: the plates that the tracer renders; the same through hot air
    trace render samples/fig7.toml --straight -o 'out/fig7-plate.####.exr' --frames 1,25,49 --overwrite
    warp 'out/fig7-plate.####.exr' -o 'out/fig7-air.####.exr' --scene samples/fig7.toml --depth :Z
    pictures=()
    for row in plate air; do
        for frame in 0001 0025 0049; do pictures+=("out/fig7-$row.$frame.exr" "${display[@]}"); done
    done
    oiiotool "${pictures[@]}" --mosaic:pad=4 3x2 -d uint8 -o out/fig7.all.png
    palette out/fig7.all.png out/fig7.png
    echo "out/fig7.png: the plates from three viewpoints, and the same through hot air"
    ;;
mirage) # the road, the same through its hot air, and as rays really go
    scene=samples/mirage.toml
    trace render $scene --straight -o out/mirage-plate.exr --samples 128 --overwrite
    warp out/mirage-plate.exr -o out/mirage-warp.exr --scene $scene --depth :Z
    trace render $scene -o out/mirage-truth.exr --samples 4 --set medium.1.cn2=0 --overwrite
    oiiotool out/mirage-plate.exr "${display[@]}" out/mirage-warp.exr "${display[@]}" --mosaic:pad=4 1x2 -o out/mirage.all.png
    palette out/mirage.all.png out/mirage.png
    oiiotool out/mirage-truth.exr "${display[@]}" -o out/mirage-truth.all.png
    palette out/mirage-truth.all.png out/mirage-truth.png
    echo "out/mirage.png: the road before and after; out/mirage-truth.png: the mirage by bent rays, without shimmer"
    ;;
*)
    echo "usage: samples/figures.sh 2|5|6|7|mirage" >&2
    exit 2
    ;;
esac
