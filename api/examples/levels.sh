#!/bin/sh
# Uploads a survey, asks for the body of a range, and writes its levels as glTF files, with curl alone.
#
#     ./levels.sh http://127.0.0.1:8080 survey.sgy 0.5 null levels
#
# An open end of the range is null. A server with keys: KEY=... ./levels.sh ... Where the survey's nodes lie, as float64 x, y, z
# of each, sample fastest: NODES=FILE ./levels.sh ...
set -eu
server=$1 survey=$2 low=$3 high=$4 out=$5

call() { curl -fsS ${KEY:+-H "Authorization: Bearer $KEY"} "$@"; }

# The address that an answer's Location header names.
location() { call -o /dev/null -D - "$@" | tr -d '\r' | sed -n 's/^[Ll]ocation: *//p'; }

volume=$server$(location -X POST -T "$survey" "$server/v1/volumes?name=survey")
echo "volume      $volume"

grid=given
if [ -n "${NODES:-}" ]; then
  grid=$(location -X POST -T "$NODES" "$volume/grids?dtype=float64")
  grid=${grid##*/}
  echo "grid        $grid"
fi

# Asking again for the same is free; each time waits for the result, up to a minute.
ask() { location -H 'Prefer: wait=60' -H 'Content-Type: application/json' -d "{\"range\": [$low, $high], \"grid\": \"$grid\"}" "$volume/extractions"; }
extraction=$server$(ask)
echo "extraction  $extraction"
mkdir -p "$out"
until call -o "$out/manifest.json" "$extraction/manifest" 2>/dev/null; do
  call "$extraction" | grep -Eq '"state": "(queued|running|done)"' || { call "$extraction"; exit 1; }
  ask >/dev/null
done

# Level 0 is the finest; the one after the last is not there.
level=0
while call -o "$out/level$level.glb" "$extraction/lods/$level.glb" 2>/dev/null; do
  echo "level $level     $(wc -c <"$out/level$level.glb") bytes"
  level=$((level + 1))
done
