#!/usr/bin/env bash
# Runs every command of a guide, as a reader would, in an empty folder beside links to the checkout.
#   run_guide.sh GUIDE.md NLOS      exit status 77 where Python lacks what the guide needs
# Commands are the lines indented by four spaces; what stands between fences is output.
set -euo pipefail
guide=$(realpath "$1")
program=$(realpath "$2")
checkout=$(realpath "$(dirname "$0")/../..")
export PATH="$(dirname "$program"):/usr/bin:$PATH"

python3 -c 'import h5py, numpy' || { echo "skipped: install python3-h5py"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
ln -s "$checkout"/{apps,data,scenes} .
awk '/^```/ { fenced = !fenced; next } !fenced && /^    / { print substr($0, 5) }' "$guide" >commands
[ -s commands ] || { echo "$guide holds no command" >&2; exit 1; }
bash -euxo pipefail commands
