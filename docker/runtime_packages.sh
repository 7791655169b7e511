#!/usr/bin/env bash
# The Debian packages that hold the shared libraries a program needs directly, one package=version a line, sorted.
# usage: runtime_packages.sh PROGRAM
set -euo pipefail
libraries=$(ldd "$1" | awk '$2 == "=>" { print $1 "=" $3 }')
objdump -p "$1" | awk '$1 == "NEEDED" { print $2 }' | while read -r name; do
  file=$(sed -n "s/^$name=//p" <<<"$libraries")
  [ -n "$file" ] || { [[ $name == ld-linux* ]] && continue; echo "runtime_packages.sh: $name is not found" >&2; exit 1; }
  # With merged /usr, packages name the one path or the other.
  package=$(dpkg-query --search "$file" "/usr$file" 2>/dev/null | sed -n '1s/:.*//p' || true)
  [ -n "$package" ] || { echo "runtime_packages.sh: $file is of no package" >&2; exit 1; }
  dpkg-query --show --showformat='${Package}=${Version}\n' "$package"
done | sort --unique
