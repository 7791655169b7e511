# shellcheck shell=bash disable=SC2086 # package lists are meant to be split
# Sourced by ./run and ./test, from the repository root: packages, configure, build.

fail() {
  echo "$(basename "$0"): $*" >&2
  exit 1
}

# A line of a list is a package, or a package and a command that makes it unnecessary, wherever that comes from.
missing_packages() {
  local package command
  grep -Ehv '^ *(#|$)' "$@" | while read -r package command; do
    [ -n "$command" ] && command -v "$command" >/dev/null && continue
    dpkg-query --show --showformat='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || echo "$package"
  done
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

update_package_lists() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get update -q
}

# install_packages LIST...: installs what the lists name and this machine lacks. Without anything missing it needs no
# network.
install_packages() {
  command -v dpkg-query >/dev/null || fail "this is not Debian: install what $* lists, then use cmake --preset release"
  local missing
  missing=$(missing_packages "$@")
  [ -n "$missing" ] || return 0
  echo "Installing missing Debian packages:" $missing
  [ "$(id -u)" -eq 0 ] || command -v sudo >/dev/null ||
    fail "neither root nor sudo: ask an administrator for: apt-get install" $missing
  update_package_lists
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing
}

# unpack_package PACKAGE COMMAND: a program of a package that would start a daemon of its own if it were installed, into
# build/PACKAGE; nothing if this machine has the command.
unpack_package() {
  local package=$1 command=$2 folder=build/$1
  PATH=$PATH:/usr/sbin command -v "$command" >/dev/null && return
  [ -e "$folder/usr/sbin/$command" ] && return
  echo "Fetching $command into $folder"
  mkdir -p "$folder"
  (cd "$folder" && apt-get download -q "$package") || {
    update_package_lists
    (cd "$folder" && apt-get download -q "$package")
  }
  dpkg-deb --extract "$folder/$package"_*.deb "$folder"
}

# Fetches the page's packages as the lock file says and bundles it, if it is not newer than its sources.
build_page() {
  local newer
  newer=$(find viewer -path viewer/node_modules -prune -o -path viewer/dist -prune -o \
    -type f -newer viewer/dist/index.html -print -quit 2>/dev/null || true)
  [ -e viewer/dist/index.html ] && [ -z "$newer" ] && return
  echo "Building the page in viewer/dist"
  local log=build/page.log
  mkdir -p build
  if ! (cd viewer && npm ci --no-audit --no-fund && npm run build) >"$log" 2>&1; then
    cat "$log" >&2
    fail "building the page failed"
  fi
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
