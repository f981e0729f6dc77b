#!/usr/bin/env bash
# Installs a build, moves what was installed elsewhere, and uses it there: the program, its scenes,
# manual and completions, and the libraries in a project of three files.
#   bash tests/install/install_test.sh BUILD_FOLDER
set -euo pipefail

build=$(realpath "$1")
consumer=$(realpath "$(dirname "$0")/consumer")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

fail() {
    echo "$1" >&2
    exit 1
}

for component in program development; do
    cmake --install "$build" --component "$component" --prefix "$scratch/installed" >/dev/null
done
mv installed moved
share=$scratch/moved/share
for file in man/man1/nlos.1.gz man/man1/nlos-render.1.gz bash-completion/completions/nlos \
    zsh/vendor-completions/_nlos doc/nlos/copyright doc/nlos/apps/guide/your_labs_file.md \
    doc/nlos/scenes/README.md \
    nlos/scenes/letter/scene.glb nlos/data/letter.h5 nlos/data/layouts/zaragoza.json \
    nlos/apps/bench/field/peers/ytal_reconstruct.py; do
    [ -s "$share/$file" ] || fail "$file was not installed"
done

moved/bin/nlos render "$share/nlos/scenes/letter/scene.json" -o letter.h5 \
    --set 'scan.sensing_points=[8,8]' time_axis.num_bins=64 >/dev/null
moved/bin/nlos info letter.h5 >/dev/null
moved/bin/nlos bench --help >/dev/null  # of the program beside it

CMAKE_GENERATOR=Ninja sh "$consumer/build.sh" "$scratch/moved" "$scratch/consumer" \
    "$share/nlos/scenes/letter/scene.json" >build.log 2>&1 ||
    { cat build.log; fail "the consumer does not build or run"; }
tail -n 2 build.log | tee errors
awk '/^reconstruction:/ { r = $5 } /^fit:/ { f = $5 }
     END { exit !(r > 0 && r < 20 && f > 0 && f < 3) }' errors || fail "the errors are too large"
! consumer/consumer nothing.json 2>message || fail "a missing scene was accepted"
[ "$(wc -l <message)" -eq 1 ] || fail "a missing scene is not refused in one line"
