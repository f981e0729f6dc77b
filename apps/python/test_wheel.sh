#!/usr/bin/env bash
# Installs a wheel in a bare Debian 12, which has Python and nothing else, and checks it there.
#   bash apps/python/test_wheel.sh WHEEL
# Needs root (or sudo) that may mount /proc, Debian's mirror and PyPI; the bare system lies below
# build/ while it runs.
set -euo pipefail
cd "$(dirname "$0")/../.."

wheel=$(realpath "$1")
bash apps/setup.sh debootstrap python3-venv
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
mirror=$(apt-get indextargets --format '$(REPO_URI)' \
    'Origin: Debian' 'Codename: bookworm' 'Component: main' 'Created-By: Packages' | head -n 1)
mkdir -p build
scratch=$(mktemp -d -p build)
trap '"${as_root[@]}" rm -rf --one-file-system "$scratch"' EXIT

# The wheel and what it depends on; the bare system itself needs no network.
/usr/bin/python3 -m venv "$scratch/tools"
"$scratch/tools/bin/pip" download --quiet --only-binary :all: --dest "$scratch/wheels" "$wheel"

"${as_root[@]}" debootstrap --variant=minbase --include=python3,python3-venv \
    bookworm "$scratch/root" "$mirror" >"$scratch/log" || { tail "$scratch/log" >&2; exit 1; }
"${as_root[@]}" cp -r "$scratch/wheels" tests/apps/python/installed_wheel.py "$scratch/root/opt"
"${as_root[@]}" unshare --mount --pid --fork --mount-proc="$scratch/root/proc" \
    chroot "$scratch/root" /usr/bin/env -i PATH=/usr/bin:/bin HOME=/root bash -euc '
        python3 -m venv /opt/python
        /opt/python/bin/pip install --quiet --no-index --find-links /opt/wheels nlos
        /opt/python/bin/python /opt/installed_wheel.py'
