#!/usr/bin/env bash
# Tries in a bare Debian what a new user does: clones the committed state, runs README's commands, and
# makes, installs, uses and removes the packages. Takes up to an hour and a half.
#   bash tests/install/bare_root.sh SUITE [demo] [tests] [package]      SUITE: bookworm or trixie
# Needs root, Debian's mirror and PyPI. The bare systems lie in build/bare and are kept: remove that
# folder to begin anew.
set -euo pipefail
cd "$(dirname "$0")/../.."
[ $# -ge 1 ] || { sed -n '2,6s/^# //p' "$0" >&2; exit 2; }

suite=$1
shift
steps=("$@")
[ $# -gt 0 ] || steps=(demo tests package)
bash apps/setup.sh debootstrap lintian
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Origin: Debian' 'Component: main' \
    'Created-By: Packages' | grep -v security | head -n 1)
mkdir -p build/bare

# A bare system in the folder, which sees /proc, /sys and /dev, and its own name, while a command runs.
make_root() {
    [ ! -e "$1/bare" ] || return 0
    rm -rf "$1"
    debootstrap --variant=minbase --include=ca-certificates "$suite" "$1" "$mirror" >"$1.log" ||
        { tail "$1.log" >&2; exit 1; }
    cp /etc/apt/apt.conf.d/99* "$1/etc/apt/apt.conf.d/" 2>/dev/null || true
    cp /etc/ssl/certs/ca-certificates.crt "$1/etc/ssl/certs/"
    [ ! -e /etc/pip.conf ] || cp /etc/pip.conf "$1/etc/"
    touch "$1/bare"
}
in_root() {
    local root=$1
    shift
    unshare --mount --pid --fork --mount-proc="$root/proc" bash -c '
        mount --rbind /dev "$0/dev"
        mount --rbind /sys "$0/sys"
        cp /etc/resolv.conf /etc/hosts "$0/etc/"
        exec chroot "$0" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
            DEBIAN_FRONTEND=noninteractive bash -euc "$1"' "$root" "$*"
}
timed() {
    local start=$SECONDS name=$1
    shift
    "$@"
    echo "$suite: $name took $((SECONDS - start)) s"
}

root=build/bare/$suite
make_root "$root"
[ -d "$root/nlos" ] || git clone -q . "$root/nlos"
git -C "$root/nlos" fetch -q "$PWD" HEAD
git -C "$root/nlos" reset -q --hard FETCH_HEAD  # what was built before stays

for step in "${steps[@]}"; do
    case "$step" in
    demo) timed "bash apps/demo.sh" in_root "$root" 'cd /nlos && bash apps/demo.sh' ;;
    tests) timed "bash tests/run.sh" in_root "$root" 'cd /nlos && bash tests/run.sh' ;;
    package)
        in_root "$root" 'cd /nlos && bash apps/setup.sh file dpkg-dev && cmake --preset package >/dev/null &&
            cmake --build --preset package && cd build/package && rm -f ./*.deb && cpack -G DEB'
        user=build/bare/$suite-user
        rm -rf "$user"
        make_root "$user"
        cp "$root"/nlos/build/package/*.deb "$user/root/"
        cp -r tests/install/consumer "$user/root/"
        lintian --fail-on error --profile debian "$user"/root/*.deb
        in_root "$user" '
            apt-get update -qq
            files() { find / -xdev \( -path /proc -o -path /dev -o -path /var -o -path /root \
                -o -path /tmp -o -path /run \) -prune -o -print | grep -i nlos | sort; }
            files >/root/before
            cd /root
            apt-get install -y -qq --no-install-recommends ./nlos_*.deb >/dev/null
            nlos demo -o demo
            [ -s demo/report.html ]
            apt-get install -y -qq --no-install-recommends g++ cmake make ./libnlos-dev_*.deb >/dev/null
            sh consumer/build.sh /usr consumer/build /usr/share/nlos/scenes/letter/scene.json
            apt-get remove -y -qq --purge nlos libnlos-dev >/dev/null
            files | diff /root/before - || { echo "files were left" >&2; exit 1; }'
        echo "$suite: the packages install, work, and are removed"
        ;;
    *) echo "unknown step $step" >&2; exit 2 ;;
    esac
done
