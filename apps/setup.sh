#!/usr/bin/env bash
# Installs what the project builds with, and packages given as arguments. Debian 12 and 13: by
# apt-get, asking nothing. Ubuntu 24.04, which has the same packages, likewise, but nobody has tested
# it. Elsewhere: prints the list and stops. Does nothing when all is there.
set -euo pipefail

packages=(
    g++ cmake ninja-build pkg-config git ca-certificates
    libembree-dev libtbb-dev libtinygltf-dev nlohmann-json3-dev libfmt-dev libcli11-dev
    libeigen3-dev libfftw3-dev libhdf5-dev libmatio-dev libopenexr-dev libflann-dev liblz4-dev libopencv-dev
    libcairo2-dev libfreetype-dev fonts-dejavu-core libpng-dev libturbojpeg0-dev zlib1g-dev libxxhash-dev libmeshoptimizer-dev
    libceres-dev libisal-dev libzip-dev libpugixml-dev libyaml-cpp-dev
    libjs-three libgtest-dev
    "$@"
)

missing=()
if command -v dpkg-query >/dev/null; then
    for package in "${packages[@]}"; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' ||
            missing+=("$package")
    done
else
    missing=("${packages[@]}")
fi
[ ${#missing[@]} -eq 0 ] && exit 0

system=unknown
[ -r /etc/os-release ] && system=$(. /etc/os-release && echo "${ID:-unknown} ${VERSION_ID:-}")
case "$system" in
"debian 12" | "debian 13") ;;
"ubuntu 24.04") echo "This is Ubuntu 24.04, where nlos is untested." >&2 ;;
*)
    echo "This is $system, not Debian 12 or 13. Please install these (Debian's names) and run again:" >&2
    printf '  %s\n' "${missing[@]}" >&2
    exit 1
    ;;
esac

as_root=()
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "Run as root, or install sudo." >&2; exit 1; }
    as_root=(sudo)
fi
echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
