#!/usr/bin/env bash
# The environments that the Python module is built and tested in, build/python and, for the field's
# other packages, build/peers.
#   bash tests/python.sh            makes them where they are missing
#   bash tests/python.sh build      only what the module is compiled with
#   bash tests/python.sh install    installs the module of the check build, as users do, and tries it
set -euo pipefail
cd "$(dirname "$0")/.."

if [ "${1:-}" = install ]; then
    # Files are joined as in that build: with the package's own number all would be compiled again.
    build/python/bin/pip install --quiet --no-build-isolation --no-deps . \
        --config-settings=build-dir=build/check --config-settings=cmake.build-type=Check \
        --config-settings=cmake.define.BUILD_TESTING=ON \
        --config-settings=cmake.define.CMAKE_UNITY_BUILD_BATCH_SIZE=32
    exec build/python/bin/python tests/apps/python/installed_wheel.py
fi
bash apps/setup.sh python3-dev python3-venv
[ -d build/python ] || /usr/bin/python3 -m venv --system-site-packages build/python
build/python/bin/pip install --quiet 'scikit-build-core>=0.10' 'nanobind>=2.4'
[ "${1:-}" != build ] || exit 0
bash apps/setup.sh python3-numpy python3-scipy python3-pytest python3-torch python3-xarray \
    python3-matplotlib python3-tqdm python3-ipython
build/python/bin/pip install --quiet trimesh
[ -x build/peers/bin/ray ] || bash apps/bench/field/install_peers.sh build/peers /usr/bin/python3
