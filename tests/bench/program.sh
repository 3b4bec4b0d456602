#!/usr/bin/env bash
# Whole programs against their peer, as medians of interleaved pairs:
#   - 16 frames of 1080p half ZIP EXR through `eikonal warp` (default scene) against `oiiotool` copying the same frames
#   - program start against oiiotool's
#   - three frames of samples/fig5.toml at 256 x 256, 300 hot blobs, against the same scene without blobs; the limit is 1.05.
#     Wall-clock time and, as a second row, processor time
# usage: tests/bench/program.sh [path to eikonal] [pairs]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
eikonal=${1:-$root/build/warp/eikonal}
pairs=${2:-7}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# A plate with the detail of a photograph: the sample plate, enlarged, with grain.
oiiotool "$root/samples/plate/road.0001.exr" --ch R,G,B,A --resize 1920x1080 --noise:type=gaussian:stddev=0.004 \
    -d half --compression zip -o "$work/in.0001.exr"
for i in $(seq -w 2 16); do cp "$work/in.0001.exr" "$work/in.00$i.exr"; done

# The plate of Fig. 5 with grain, so that bent or not it compresses alike, three frames of it; its scene without blobs.
for i in 1 2 3; do
    oiiotool "$root/samples/checker.png" --resize 256x256 --noise:type=gaussian:stddev=0.02 -o "$work/plate.000$i.png"
done
sed 's/^rate = .*/rate = 0/' "$root/samples/fig5.toml" >"$work/empty.toml"

seconds() { local TIMEFORMAT=%R; { time "$@" >/dev/null 2>"$work/log"; } 2>&1; }
warp() { rm -f "$work"/w.*; seconds "$eikonal" warp "$work/in.####.exr" -o "$work/w.####.exr" --progress none; }
copy() { rm -f "$work"/c.*; seconds oiiotool "$work/in.#.exr" -o "$work/c.#.exr"; }
start() { seconds "$eikonal" --version; }
peer_start() { seconds oiiotool --help; }

fig5() { "$1" "$eikonal" warp "$work/plate.####.png" -o "$work/b.####.png" --scene "$2" --overwrite --progress none; }
blobs() { fig5 seconds "$root/samples/fig5.toml"; }
no_blobs() { fig5 seconds "$work/empty.toml"; }
processor() { local TIMEFORMAT='%U %S'; { time "$@" >/dev/null 2>"$work/log"; } 2>&1 | awk '{ printf "%.3f", $1 + $2 }'; }
blobs_processor() { fig5 processor "$root/samples/fig5.toml"; }
no_blobs_processor() { fig5 processor "$work/empty.toml"; }

# median of the ratios A/B over interleaved pairs, and both medians
compare() {
    local a b
    "$2" >/dev/null; "$3" >/dev/null
    for _ in $(seq "$pairs"); do a=$("$2"); b=$("$3"); echo "$a $b"; done |
        awk -v name="$1" '{ a[NR] = $1; b[NR] = $2; r[NR] = $1 / $2 }
            function median(x, n,   i, j, t) {
                for (i = 2; i <= n; i++) { t = x[i]; for (j = i - 1; j > 0 && x[j] > t; j--) x[j + 1] = x[j]; x[j + 1] = t }
                return n % 2 ? x[(n + 1) / 2] : (x[n / 2] + x[n / 2 + 1]) / 2 }
            END { printf "%-44s %.3f s, peer %.3f s, ratio %.2f\n", name, median(a, NR), median(b, NR), median(r, NR) }'
}
compare "16 frames 1080p, warp / oiiotool copy" warp copy
compare "start, eikonal / oiiotool" start peer_start
pairs=$((10 * pairs))
compare "300 blobs, 3 frames / none" blobs no_blobs
compare "300 blobs, 3 frames / none, processor time" blobs_processor no_blobs_processor
