#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Measures plans of many parts: bytes of the parts, and time and memory of planning, checking and merging.
#
#   tests/bench/farm.sh BIN [FOLDER] [COUNTS]
#
# BIN contains quintet and quintet_farm_parts (QUINTET_BENCHMARKS=ON). COUNTS: numbers of parts (default "10 100 1000"). One part is
# rendered, and the others are copies of it with other samples. Everything is in a new folder in FOLDER (/tmp), and removed.
# Environment: SIZE (480x270), AOV (all), SCENE (examples/scenes/spheres.scene.toml), DEVICE (the default).
#
# Columns: parts; bytes of one part and of all; seconds of wall clock of plan, status, status --verify and merge; processor time of
# the merge, which other jobs on the machine do not change; memory of the merge (peak of the process), MiB.
set -euo pipefail
bin=${1:?usage: tests/bench/farm.sh BIN [FOLDER] [COUNTS]}
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d "${2:-/tmp}/farm-XXXXXX")
counts=${3:-10 100 1000}
trap 'rm -rf "$folder"' EXIT
size=${SIZE:-480x270} aov=${AOV:-all} scene=${SCENE:-$root/examples/scenes/spheres.scene.toml}
device=()
[ -z "${DEVICE:-}" ] || device=(--device "$DEVICE")

# seconds COMMAND…: its wall clock.
seconds() { /usr/bin/time -f '%e' -o "$folder/seconds" "$@" > /dev/null && cat "$folder/seconds"; }

echo "$(uname -m), $(nproc) cores; $(basename "$scene"), $size, --aov $aov"
printf '%7s %12s %14s %8s %8s %8s %8s %8s %12s\n' parts 'part [B]' 'all [B]' plan status verify merge cpu 'memory [MiB]'
for count in $counts; do
  rm -rf "$folder/farm"
  plan=$(seconds "$bin/quintet" farm plan "$scene" -o "$folder/farm" --size "$size" --spp $((4 * count)) --parts "$count" \
    --aov "$aov" --image image.exr -q "${device[@]}")
  "$bin/quintet" farm run "$folder/farm" 0 -q
  "$bin/quintet_farm_parts" "$folder/farm"
  bytes=$(stat -c %s "$folder/farm/parts/000/000000.qfilm")
  all=$(du -sb "$folder/farm/parts" | cut -f1)
  status=$(seconds "$bin/quintet" farm status "$folder/farm")
  verify=$(seconds "$bin/quintet" farm status "$folder/farm" --verify)
  /usr/bin/time -f '%e %U %S %M' -o "$folder/merge" "$bin/quintet" farm merge "$folder/farm" -q
  read -r merge user system memory < "$folder/merge"
  cpu=$(awk "BEGIN { printf \"%.2f\", $user + $system }")
  printf '%7s %12s %14s %8s %8s %8s %8s %8s %12s\n' "$count" "$bytes" "$all" "$plan" "$status" "$verify" "$merge" "$cpu" \
    $((memory / 1024))
done
