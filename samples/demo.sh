#!/usr/bin/env bash
# Sets eikonal up (.ci/setup: installs what is missing, builds) and makes the sample plate shimmer, into out/. Run again,
# it keeps what is done already; rm -r out makes it anew.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

.ci/setup -DEIKONAL_TESTS=OFF

plate=samples/plate/road.0001.exr
air=(--scene samples/demo.toml --depth :Z --filter area --frames 1-48)
frame=out/shimmer.0016.exr
mkdir -p out

echo "48 frames of hot air over $plate:"
build/warp/eikonal warp "$plate" -o 'out/shimmer.####.exr' "${air[@]}"
echo "The same as a movie:"
build/warp/eikonal warp "$plate" -o out/shimmer.mp4 "${air[@]}"

if [ ! out/before-after.png -nt "$frame" ]; then
    # left before, right after; below, three times enlarged
    show=(--ch R,G,B --colorconvert linear sRGB --clamp:min=0:max=1)
    enlarge=(--cut 213x120+150+125 --resize:filter=mitchell 640x360)
    oiiotool "$plate" "${show[@]}" "$frame" "${show[@]}" "$plate" "${show[@]}" "${enlarge[@]}" "$frame" "${show[@]}" "${enlarge[@]}" \
        --mosaic:pad=4 2x2 -d uint8 -o out/before-after.png
fi

cat <<END

Done. In $PWD/out:
  shimmer.0001.exr to shimmer.0048.exr   the shimmering sequence, linear light, with its depth channel
  shimmer.mp4                            the same as a movie
  before-after.png                       the plate and frame 16, side by side
END
