#!/usr/bin/env bash
# Builds the images of docker/Dockerfile without Docker: a Debian root by mmdebstrap stands in for debian:bookworm-slim.
# As root, with what .ci/packages.container lists; needs the network. Layers are kept in build/images for the next time.
# usage: images.sh         prints each image with its size; leaves its root in build/images/NAME and its settings in NAME.json
set -euo pipefail
cd "$(dirname "$0")/.."
. .ci/setup.sh
[ "$(id -u)" -eq 0 ] || {
  echo "images.sh: skipped, it needs root" >&2
  exit 77
}
install_packages .ci/packages.container

work=$PWD/build/images
mkdir -p "$work"
# Layers by overlay where a mount shows that it works here; else each one is a copy of everything below it.
driver=vfs
mkdir -p "$work"/probe/{lower,upper,work,root}
if mount -t overlay overlay -o "lowerdir=$work/probe/lower,upperdir=$work/probe/upper,workdir=$work/probe/work" "$work/probe/root" 2>/dev/null; then
  umount "$work/probe/root"
  driver=overlay
fi
cat >"$work/storage.conf" <<TEXT
[storage]
driver = "$driver"
graphroot = "$work/storage-$driver"
runroot = "$work/run"
TEXT
# Buildah leaves its storage mounted on itself; then the build folder could not be removed.
trap 'umount "$work/storage-$driver/overlay" 2>/dev/null || true' EXIT
echo '{"default": [{"type": "insecureAcceptAnything"}]}' >"$work/policy.json"
export CONTAINERS_STORAGE_CONF=$work/storage.conf BUILDAH_ISOLATION=chroot BUILDAH_FORMAT=docker
base=docker.io/library/debian:bookworm-slim

# Slim as the official image is: without manuals, translations and most documentation.
if [ ! -e "$work/root.tar" ]; then
  options=(--dpkgopt=force-unsafe-io)
  for folder in man locale info groff doc; do options+=(--dpkgopt="path-exclude=/usr/share/$folder/*"); done
  # What this machine trusts beside Debian's certificates, the root trusts as well: a proxy's authority, for example.
  mmdebstrap --quiet --variant=minbase "${options[@]}" --dpkgopt='path-include=/usr/share/doc/*/copyright' \
    --customize-hook='mkdir -p "$1/usr/local/share/ca-certificates"' \
    --customize-hook='find /usr/local/share/ca-certificates -name "*.crt" -exec cp {} "$1/usr/local/share/ca-certificates/" \;' \
    bookworm "$work/root.tar"
fi
if ! buildah inspect --type image "$base" >/dev/null 2>&1; then
  printf 'FROM scratch\nADD root.tar /\nCMD ["bash"]\n' >"$work/base.Dockerfile"
  buildah bud --quiet --signature-policy "$work/policy.json" --tag "$base" --file "$work/base.Dockerfile" "$work"
fi

for target in geosis edge; do
  buildah bud --pull-never --layers --signature-policy "$work/policy.json" --timestamp 0 \
    --ignorefile docker/Dockerfile.dockerignore --file docker/Dockerfile --target "$target" --tag "localhost/$target" .
  buildah inspect --type image "localhost/$target" >"$work/$target.json"
  container=$(buildah from --pull-never --signature-policy "$work/policy.json" "localhost/$target")
  rm -rf "${work:?}/$target"
  cp --archive "$(buildah mount "$container")" "$work/$target"
  buildah rm "$container" >/dev/null
done

bytes() { du --summarize --block-size=1 --apparent-size "$1" | cut -f 1; }
for target in geosis edge; do
  echo "image $target: $(($(bytes "$work/$target") / 1000000)) MB, of which $(($(stat --format=%s "$work/root.tar") / 1000000)) MB are Debian's root"
done
