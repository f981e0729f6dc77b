#!/usr/bin/env bash
# From a fresh Debian 12 to a finished demo: packages, release build, nlos demo.
set -euo pipefail
cd "$(dirname "$0")/.."

bash apps/setup.sh
echo "Building (release)"
cmake --preset release >/dev/null
cmake --build --preset release --target nlos_cli
build/release/apps/nlos demo -o out/demo
echo "Open $(pwd)/out/demo/report.html"
