#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test. Arguments go to cmake.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
.ci/setup -DEIKONAL_TESTS=ON "$@"
exec ctest --test-dir build --output-on-failure -j "$(nproc)"
