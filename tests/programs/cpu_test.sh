#!/bin/sh
# Same bytes on every x86-64 processor: runs `eikonal` on emulated processors, from one without AVX to the newest that
# qemu knows, and on the real one, and compares the files.
#
#     tests/programs/cpu_test.sh build/warp/eikonal [CPU...]       (qemu's names; without: Nehalem Haswell max)
#
# Not a ctest: it needs qemu-x86_64 (Debian's qemu-user) and takes some minutes. Exit status 0: all files agree.
set -eu

eikonal=$(realpath "${1:?usage: cpu_test.sh PATH/TO/eikonal [CPU...]}")
shift
[ $# -gt 0 ] || set -- Nehalem Haswell max
qemu=$(command -v qemu-x86_64) || { echo "cpu_test: qemu-x86_64 is missing: install Debian's qemu-user" >&2; exit 2; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT INT TERM
cd "$folder"

oiiotool --pattern fill:topleft=1,0,0:topright=0,1,0:bottomleft=0,0,1:bottomright=1,1,1 64x48 3 \
         --noise:type=uniform:min=0:max=0.3:seed=5 -d half -o plate.exr -d uint8 -o plate.png
cat > noise.toml <<'SCENE'
[camera]
horizontal_fov = 10
[[medium]]
type = "turbulence"
form = "gradient-noise"
cn2 = 1e-9
outer_scale = 0.5
inner_scale = 0.05
SCENE

# run NAME COMMAND...: the same work, into files that begin with NAME
run() {
    name=$1
    shift
    for preset in gentle campfire; do
        "$@" map --preset $preset --set "camera.resolution=[64,48]" --frames 1,7 -o "$name.$preset.####.exr" --progress none
    done
    "$@" map --scene noise.toml --distance 20 --set "camera.resolution=[64,48]" --frames 3 -o "$name.noise.####.exr" --progress none
    "$@" warp plate.exr -o "$name.warp.exr" --rms 2 --filter lanczos3 --dispersion 1 --progress none
    "$@" warp plate.exr -o "$name.area.exr" --rms 2 --filter area --shutter 0.5 --progress none
    "$@" warp plate.png -o "$name.warp.png" --rms 2 --progress none
}

run native "$eikonal"
status=0
for cpu in "$@"; do
    if ! "$qemu" -cpu $cpu "$eikonal" --version > /dev/null 2> /dev/null; then
        echo "$cpu: this qemu cannot run the program on it"
        continue
    fi
    run $cpu "$qemu" -cpu $cpu "$eikonal" 2> messages || { cat messages >&2; exit 1; }
    same=0 other=0
    for file in native.*; do
        if cmp -s "$file" "$cpu.${file#native.}"; then same=$((same + 1)); else
            other=$((other + 1)) status=1
            echo "$cpu: ${file#native.} differs"
        fi
    done
    echo "$cpu: $same files agree with the real processor, $other differ"
done
exit $status
