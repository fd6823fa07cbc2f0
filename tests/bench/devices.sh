#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Measures what several devices of one machine gain, and checks that their images have the same pixels.
#
#   tests/bench/devices.sh BIN [FOLDER] [COUNTS]
#
# BIN contains quintet and quintet_make_scenes. COUNTS: numbers of devices (default "1 2 4"; more than the machine has are
# skipped). Scenes and images are created in a new folder in FOLDER (/tmp) and removed. Environment: SPP (4096), SIZE
# (1920x1080), REPEAT (3: the fastest run counts), DEVICES (a list to take the devices from, such as 0,0 on a machine with one),
# MORE (further options of render, such as --adaptive).
#
# Columns: wall clock of the process; of rendering, until the last sample; speedups relative to the first count; whether all
# pixels have the bits of the first count.
# The status is 1 if pixels differ.
set -euo pipefail
bin=${1:?usage: tests/bench/devices.sh BIN [FOLDER] [COUNTS]}
folder=$(mktemp -d "${2:-/tmp}/devices-XXXXXX")
counts=${3:-1 2 4}
trap 'rm -rf "$folder"' EXIT
spp=${SPP:-4096} size=${SIZE:-1920x1080} repeat=${REPEAT:-3}
read -ra more <<<"${MORE:-}"

number() { grep -o "\"$1\":[-0-9.e+]*" <<<"$2" | tail -1 | cut -d: -f2; }
seconds() { grep -o '"seconds":{[^}]*}' <<<"$1" | head -1; }

"$bin/quintet_make_scenes" "$folder"
if [ -n "${DEVICES:-}" ]; then
  IFS=, read -ra devices <<<"$DEVICES"
else
  # As many as --device all uses.
  count=$("$bin/quintet" render "$folder/bench.glb" --size 8x8 --spp 1 -q --json -o "$folder/one.png" --device all |
    grep -o '"deviceCount":[0-9]*' | cut -d: -f2 || true)
  mapfile -t devices < <(seq 0 $((${count:-1} - 1)))
fi
echo "$(uname -m), $(nproc) cores, ${#devices[@]} devices; bench.glb, sky.hdr, $size, $spp samples ${more[*]:-}"

first=
status=0
printf '%7s %12s %9s %12s %9s  %s\n' devices 'process [s]' speedup 'render [s]' speedup pixels
for count in $counts; do
  [ "$count" -le "${#devices[@]}" ] || continue
  list=$(IFS=,; echo "${devices[*]:0:count}")
  process=
  for _ in $(seq "$repeat"); do
    json=$("$bin/quintet" render "$folder/bench.glb" --env "$folder/sky.hdr" --size "$size" --spp "$spp" \
      --device "$list" -q --json -o "$folder/$count.exr" --exr-type float "${more[@]}")
    total=$(number total "$(seconds "$json")")
    if [ -z "$process" ] || awk "BEGIN { exit !($total < $process) }"; then
      process=$total render=$(number render "$(seconds "$json")")
    fi
  done
  if [ -z "$first" ]; then first=$count firstProcess=$process firstRender=$render; fi
  same=same
  "$bin/quintet" compare "$folder/$count.exr" "$folder/$first.exr" --metric rmse --max 0 >"$folder/difference" 2>&1 || {
    same=DIFFERENT
    status=1
  }
  awk "BEGIN { printf \"%7d %12.3f %9.2f %12.3f %9.2f  %s\n\", $count, $process, $firstProcess / $process, $render,
    $firstRender / $render, \"$same\" }"
done
exit $status
