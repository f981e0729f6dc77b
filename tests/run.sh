#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors, and runs every test.
#   bash tests/run.sh [PRESET] [CTEST ARGUMENTS ...]      PRESET: check (default), dev or sanitize
# The Python module is built and tested too, but not by sanitize: Python itself lacks the sanitizers.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-check}
[ $# -gt 0 ] && shift
bash apps/setup.sh
module=()
if [ "$preset" != sanitize ]; then
    bash tests/python.sh build
    module=(-DNLOS_PYTHON=ON "-DPython_EXECUTABLE=$PWD/build/python/bin/python")
fi

# While it compiles: what tests alone need. They write the layouts of other groups, read data sets,
# and use pages as a browser's user does.
install_for_tests() {
    bash apps/setup.sh python3-h5py python3-numpy python3-scipy python3-torch \
        chromium chromium-driver python3-selenium python3-pil
    [ "$preset" = sanitize ] || bash tests/python.sh
}
install_for_tests &
for_tests=$!

cmake --preset "$preset" "${module[@]}" >/dev/null
cmake --build --preset "$preset" --parallel "$(nproc)"
wait "$for_tests"
[ "$preset" != check ] || bash tests/python.sh install
ctest --preset "$preset" "$@"
