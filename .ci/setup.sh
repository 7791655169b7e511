# shellcheck shell=bash disable=SC2086 # package lists are meant to be split
# Sourced by ./run and ./test, from the repository root: packages, configure, build.

fail() {
  echo "$(basename "$0"): $*" >&2
  exit 1
}

missing_packages() {
  local package
  grep -Ev '^ *(#|$)' .ci/packages | while read -r package; do
    dpkg-query --show --showformat='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || echo "$package"
  done
}

# Installs what .ci/packages lists and this machine lacks. Without anything missing it needs no network.
install_packages() {
  command -v dpkg-query >/dev/null || fail "this is not Debian: install what .ci/packages lists, then use cmake --preset release"
  local missing as_root=()
  missing=$(missing_packages)
  [ -n "$missing" ] || return 0
  echo "Installing missing Debian packages:" $missing
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || fail "neither root nor sudo: ask an administrator for: apt-get install" $missing
    as_root=(sudo)
  fi
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing
}

# build TARGET...: configures and builds build/release; says nothing of the steps unless one fails.
build() {
  echo "Building $* in build/release"
  local log=build/release/setup.log
  mkdir -p build/release
  if ! cmake --preset release >"$log" 2>&1; then
    cat "$log" >&2
    fail "configuring failed"
  fi
  cmake --build build/release --parallel "$(nproc)" --target "$@"
}
