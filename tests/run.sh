#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors, and runs every test.
#   bash tests/run.sh [PRESET] [CTEST ARGUMENTS ...]      PRESET: check (default), dev or sanitize
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-check}
[ $# -gt 0 ] && shift
bash apps/setup.sh python3-h5py python3-numpy python3-scipy  # they write the layouts of other groups
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset"
ctest --preset "$preset" "$@"
