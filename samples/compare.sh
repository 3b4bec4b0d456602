#!/usr/bin/env bash
# Holds every model of the warp against the tracer on the scenes of samples/compare/, into out/compare/SCENE/index.html, and
# writes the table of compare/README.md again. Needs a build (.ci/setup), in build/ or where BUILD says. A few minutes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
trace=${BUILD:-build}/reference/eikonal-trace
readme=samples/compare/README.md
scenes=(weak strong folding silhouette wide near-far long-folding blobs mirage mirage-plumes moving)

for scene in "${scenes[@]}"; do
    echo "$scene"
    case $scene in
    moving) more=(--frames 1-4) ;;
    *) more=() ;;
    esac
    "$trace" compare "samples/compare/$scene.toml" -o "out/compare/$scene" --samples 2 --overwrite "${more[@]}" > /dev/null
done

# fact SCENE LABEL: the first words of a fact, up to a comma or bracket
fact() { sed -n "s/^$2  *\([^,(]*[^,( ]\).*/\1/p" "out/compare/$1/errors.txt"; }
table() {
    echo '| Scene | True displacement, focusing | Model | p95 smooth | stated p95 | p95 near silhouettes | p95 | p99 | p95 frame to frame | SSIM | map + warp ms | times faster |'
    echo '|---|---|---|---|---|---|---|---|---|---|---|---|'
    for scene in "${scenes[@]}"; do
        title="[$scene]($scene.toml)"
        facts="$(fact "$scene" 'true displacement'), $(fact "$scene" 'focusing variance' | sed 's/ at .*//')"
        awk -F, -v title="$title" -v facts="$facts" '
            function shown(v) { return v == "" ? "–" : v >= 100 ? sprintf("%.0f", v) : sprintf("%.2g", v) }
            NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
            $1 == "none" { next }
            {
                printf "| %s | %s | %s%s | %s | %s | %s | %s | %s | %s | %.3f | %s | %s |\n", title, facts, $1,
                    $2 == 1 && $1 != "default" ? " (default)" : "", shown($column["smooth_p95"]), shown($column["stated_p95"]),
                    shown($column["silhouette_p95"]), shown($column["p95"]),
                    shown($column["p99"]), "temporal_p95" in column ? shown($column["temporal_p95"]) : "–",
                    $column["ssim"], shown($column["map_ms"] + $column["warp_ms"]), shown($column["times_faster"])
                title = facts = ""
            }' "out/compare/$scene/errors.csv"
    done
}

table > out/compare/table.md
awk -v table=out/compare/table.md '
    /<!-- table ends -->/ { skip = 0 }
    !skip { print }
    /<!-- table begins/ { while ((getline line < table) > 0) print line; skip = 1 }' "$readme" > out/compare/README.md
cp out/compare/README.md "$readme"
cp out/compare/strong/frontier.svg samples/pictures/frontier.svg
echo "out/compare/SCENE/index.html: the pages; $readme: the table"
