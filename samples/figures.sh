#!/usr/bin/env bash
# Makes the pictures of the paper again, a mirage, the truth beside them and a shadowgraph, into out/:
# samples/figures.sh 2|5|6|7|mirage|truth|shadowgraph. Needs a build (.ci/setup), in build/ or where BUILD says.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mkdir -p out
build=${BUILD:-build}
warp() { "$build/warp/eikonal" warp "$@" --overwrite --progress none; }
trace() { "$build/reference/eikonal-trace" "$@" 2>/dev/null; }
palette() { ffmpeg -v error -y -i "$1" -vf 'split[a][b];[a]palettegen[p];[b][p]paletteuse=dither=none' "$2" && rm "$1"; }
display=(--ch R,G,B --colorconvert linear sRGB -d uint8)


# rms and maximum over pictures of a squared shift, of oiiotool's statistics
pixels() {
    oiiotool "$@" | awk '/Stats Max/ { if ($3 > max) max = $3 } /Stats Avg/ { sum += $3; n++ }
        END { printf "%.3f px rms, %.2f at most", sqrt(sum / n), sqrt(max) }'
}
# both NAME FRAMES SAMPLES MOST: a scene by the first order and by true rays; `first`, `truth` and `apart`, by how much
# they differ (black 0, brightest MOST pixels), are words for oiiotool's mosaic
both() {
    local name=$1 shift=(--ch u,v) square=(--dup --mul --chsum) moved=() off=() frame a b
    first=() truth=() apart=()
    for frame in ${2//,/ }; do
        a=out/$name-first.$frame.exr b=out/$name-truth.$frame.exr
        trace render "samples/$name.toml" -o "$a" --frames "$frame" --samples "$3" --overwrite --integrator first-order
        trace render "samples/$name.toml" -o "$b" --frames "$frame" --samples "$3" --overwrite
        first+=("$a" "${display[@]}")
        truth+=("$b" "${display[@]}")
        moved+=("$b" "${shift[@]}" "${square[@]}" --printstats)
        off+=("$a" "${shift[@]}" "$b" "${shift[@]}" --sub "${square[@]}" --printstats)
        apart+=("$a" "${shift[@]}" "$b" "${shift[@]}" --sub "${square[@]}" --powc 0.5 --divc "$4" --colormap inferno)
    done
    echo "$name: displaced by $(pixels "${moved[@]}"); first order is off by $(pixels "${off[@]}")"
}

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
mirage) # the road, and the same through its hot air
    scene=samples/mirage.toml
    trace render $scene --straight -o out/mirage-plate.exr --samples 128 --overwrite
    warp out/mirage-plate.exr -o out/mirage-warp.exr --scene $scene --depth :Z
    oiiotool out/mirage-plate.exr "${display[@]}" out/mirage-warp.exr "${display[@]}" --mosaic:pad=4 1x2 -o out/mirage.all.png
    palette out/mirage.all.png out/mirage.png
    echo "out/mirage.png: the road before and after"
    ;;
truth) # the same air by the first order and as rays really go, in some minutes
    for figure in 5 6; do
        both fig$figure 49 8 0.5
        oiiotool "${first[@]}" "${truth[@]}" "${apart[@]}" --mosaic:pad=4 3x1 -d uint8 -o out/fig$figure-truth.all.png
        palette out/fig$figure-truth.all.png out/fig$figure-truth.png
    done
    both fig7 1,25,49 4 3
    oiiotool "${first[@]}" "${truth[@]}" "${apart[@]}" --mosaic:pad=4 3x3 -d uint8 -o out/fig7-truth.all.png
    palette out/fig7-truth.all.png out/fig7-truth.png
    echo "out/fig5-truth.png, fig6-truth.png, fig7-truth.png: first order, truth, by how much they differ"
    for rays in first-order adaptive; do
        trace render samples/mirage.toml -o out/mirage-$rays.exr --set medium.1= --samples 8 --integrator $rays --overwrite
    done
    oiiotool out/mirage-{first-order,adaptive}.exr --mosaic:pad=4 2x1 "${display[@]}" -o out/mirage-truth.all.png
    palette out/mirage-truth.all.png out/mirage-truth.png
    echo "out/mirage-truth.png: the mirage by the first order and as rays really go, without shimmer"
    ;;
shadowgraph) # sunlight bent by a plume, onto a wall
    trace render samples/shadowgraph.toml -o out/shadowgraph.exr --light-rays 1024 --tolerance 0.1 --samples 4 --overwrite
    oiiotool out/shadowgraph.exr "${display[@]}" --compression jpeg:90 -o out/shadowgraph.jpg
    echo "out/shadowgraph.jpg: the shadow of hot air"
    ;;
*)
    echo "usage: samples/figures.sh 2|5|6|7|mirage|truth|shadowgraph" >&2
    exit 2
    ;;
esac
