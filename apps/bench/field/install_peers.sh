#!/usr/bin/env bash
# Makes a virtual environment of peers for `nlos bench field` and mitransient_and_ytal.ipynb: mitransient,
# y-tal, what they need, what runs a notebook; and Ray for generate_with_ray.py. `nlos` itself comes from
# PYTHONPATH, or from `DIR/bin/pip install .` afterwards. A second run changes nothing.
#   bash apps/bench/field/install_peers.sh DIR [PYTHON]
set -euo pipefail
[ $# -ge 1 ] || { sed -n '2,5s/^# //p' "$0" >&2; exit 2; }
folder=$1
python=${2:-python3}

# Dr.Jit compiles by LLVM, of which Debian 12 has a version that it works with under this name.
if [ ! -e /usr/lib/x86_64-linux-gnu/libLLVM.so.19.1 ]; then
    as_root=()
    [ "$(id -u)" -eq 0 ] || as_root=(sudo)
    "${as_root[@]}" apt-get update -qq
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -y -qq --no-install-recommends libllvm19 python3-venv >/dev/null
fi

[ -x "$folder/bin/python" ] || "$python" -m venv "$folder"
# y-tal 0.20 wants NumPy 1, which Python 3.13 (Debian 13) has no wheels of: there it is left out. It
# comes without PyVista, a third of all, which only its plot3d() takes.
pip=("$folder/bin/python" -m pip install --quiet --disable-pip-version-check)
"${pip[@]}" mitsuba==3.9.1 drjit==1.5.0 mitransient==1.3.1 pyfftw==0.15.1 \
    'numpy==1.26.4; python_version < "3.13"' 'numpy>=2.1,<2.4; python_version >= "3.13"' \
    scipy==1.17.1 h5py==3.16.0 matplotlib==3.11.2 numba==0.68.1 llvmlite==0.50.0 \
    ipython==9.18.1 ray==2.60.0 \
    'pillow==10.3.0; python_version < "3.13"' imageio==2.25.1 dill==0.4.1 nptyping==2.5.0 \
    psutil==7.2.2 pyyaml==6.0.4 setuptools==84.2.1 tqdm==4.70.1
"${pip[@]}" --no-deps 'y-tal==0.20.0; python_version < "3.13"'
"$folder/bin/python" - <<'PYTHON'
from importlib import metadata, util
import mitsuba
mitsuba.set_variant("llvm_ad_rgb")
import mitransient, pyfftw
print("mitsuba", mitsuba.__version__, "mitransient", mitransient.__version__,
      "y-tal", metadata.version("y-tal") if util.find_spec("tal") else "left out")
PYTHON
