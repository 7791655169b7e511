#!/usr/bin/env bash
# Proves the two commands on a Debian 12 with nothing installed: a minimal root, a clone of HEAD, ./run --once twice (the
# second time without network) and ./test, each with its time. As root, with mmdebstrap and git; needs the network.
set -euo pipefail
cd "$(dirname "$0")/.."

root=$(mktemp -d /tmp/geosis-bare-root-XXXXXX)
trap 'rm -rf --one-file-system "$root"' EXIT

in_root() {
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 "${network[@]}" chroot "$root" "$@"
}

mmdebstrap --quiet --variant=minbase bookworm "$root"
# What this machine trusts beside Debian's certificates, the root trusts as well: a proxy's authority, for example.
mkdir -p "$root/usr/local/share/ca-certificates"
find /usr/local/share/ca-certificates -name '*.crt' -exec cp {} "$root/usr/local/share/ca-certificates/" \;
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
mount --make-rslave "$root/dev"
trap 'umount -R "$root/proc" "$root/dev"; rm -rf --one-file-system "$root"' EXIT
git clone --quiet --no-hardlinks . "$root/geosis"
network=()
time in_root /geosis/run --once
network=(unshare --net sh -c 'ip link set lo up 2>/dev/null; exec "$@"' sh)
time in_root /geosis/run --once
network=()
time in_root /geosis/.ci/run
