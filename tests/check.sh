#!/usr/bin/env bash
# The checks that CI makes besides the tests; each can be run by itself, from anywhere.
#
#   tests/check.sh format        clang-format has nothing to change in any C++ file (`format --write` changes it)
#   tests/check.sh tidy [FILE]   clang-tidy over these .cpp files, or all outside tests/, which have libraries of GCC's own;
#                                needs a configured build/
#   tests/check.sh sanitizers    builds the fast suites with the address and undefined-behaviour sanitizers, and runs them
#   tests/check.sh repository    citations, arrows between folders, READMEs' tables, lengths (`repository --write` writes the tables)
#
# Exit status: 0 nothing found, 1 something found, 2 wrong usage.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# Suites that need no program, cover every folder that reads what users wrote, and take seconds even so.
sanitized=(portable_math spectrum lattice path_tables screens gradient_noise surface profile blob_instant wind extremes_media
           resample area displacement_grid sequence transfer picture_read image camera scene scene_fuzz)

sources() { git ls-files -co --exclude-standard -- "$@" | while read -r file; do [ -f "$file" ] && echo "$file"; done; }

check_format() {
    if [ "${1:-}" = --write ]; then
        sources '*.cpp' '*.h' | xargs clang-format -i
    elif ! findings=$(sources '*.cpp' '*.h' | xargs clang-format --dry-run --Werror 2>&1); then
        sed -n 's/:[0-9]*:[0-9]*: error:.*//p' <<<"$findings" | sort | uniq -c
        echo "These files differ from .clang-format in so many places; run: tests/check.sh format --write" >&2
        return 1
    fi
}

check_tidy() {
    [ -f build/compile_commands.json ] || cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release >/dev/null
    if [ $# -gt 0 ]; then printf '%s\n' "$@"; else sources 'noise/*.cpp' 'warp/*.cpp' 'reference/*.cpp'; fi |
        xargs -P "$(nproc)" -n 4 clang-tidy --quiet -p build --extra-arg=-Wno-unknown-warning-option \
            2> >(grep -v 'warnings\? generated' >&2) || return 1
}

check_sanitizers() {
    export ASAN_OPTIONS=exitcode=99 UBSAN_OPTIONS=exitcode=99:halt_on_error=1:print_stacktrace=1
    cmake -S . -B build-fast-asan -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1" \
        -DEIKONAL_SANITIZE=address,undefined -DEIKONAL_WARNINGS_ARE_ERRORS=OFF >/dev/null
    local targets=()
    for suite in "${sanitized[@]}"; do
        case "$suite" in *_fuzz) targets+=("$suite") ;; *) targets+=("${suite}_test") ;; esac
    done
    cmake --build build-fast-asan --target "${targets[@]}"
    ctest --test-dir build-fast-asan --output-on-failure -j "$(nproc)" -R "^($(IFS='|'; echo "${sanitized[*]}"))\$"
}

check_repository() { python3 tests/repository/repository_test.py "$@"; }

command=${1:-}
case "$command" in
    format | tidy | sanitizers | repository) shift; "check_$command" "$@" ;;
    *) sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
esac
