#!/bin/sh
# Builds and runs the program beside this file with an installed nlos.
#   build.sh PREFIX BUILD_FOLDER SCENE.json
set -e
cmake -S "$(dirname "$0")" -B "$2" -DCMAKE_PREFIX_PATH="$1" -DCMAKE_BUILD_TYPE=Release
cmake --build "$2"
"$2/consumer" "$3"
