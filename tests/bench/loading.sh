#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Measures the time from file to first pixel, and the memory.
#
#   tests/bench/loading.sh BIN [FOLDER] [TRIANGLES]
#
# BIN contains quintet and quintet_make_large. Scenes and caches are created in a new folder in FOLDER (/tmp) and removed.
# The first run of each scene has empty shader and pipeline caches. The scene files are in the page cache.
set -e
bin=${1:?usage: tests/bench/loading.sh BIN [FOLDER] [TRIANGLES]}
folder=$(mktemp -d "${2:-/tmp}/loading-XXXXXX")
triangles=${3:-10000000}
trap 'rm -rf "$folder"' EXIT
size=${SIZE:-1280x720}

number() { grep -o "\"$1\":[-0-9.e+]*" <<<"$2" | head -1 | cut -d: -f2; }
object() { grep -o "\"$1\":{[^}]*}" <<<"$2"; }

render() {  # LABEL SCENE CACHE
  local start end json stages memory peak
  export QUINTET_CACHE_DIR=$folder/$3/quintet MESA_SHADER_CACHE_DIR=$folder/$3/mesa
  export __GL_SHADER_DISK_CACHE_PATH=$folder/$3/gl CUDA_CACHE_PATH=$folder/$3/cuda
  mkdir -p "$__GL_SHADER_DISK_CACHE_PATH"
  start=$(date +%s%N)
  json=$("$bin/quintet" render "$2" --size "$size" --spp 1 -q --json -o "$folder/out.png")
  end=$(date +%s%N)
  stages=$(object stages "$json") memory=$(object memory "$json") peak=$(object devicePeak "$json")
  printf '%-22s first pixel %7.3f s   process %7.3f s   ratio %6.3f\n' "$1" "$(number firstPixel "$json")" \
    "$(awk "BEGIN { print ($end - $start) * 1e-9 }")" "$(number ratio "$memory")"
  [ -z "$QUIET" ] || return 0
  echo "  $(sed 's/"stages":{//; s/[}"]//g' <<<"$stages" | awk -F, '{ for (i = 1; i <= NF; ++i) { split($i, p, ":"); printf "%s %.3f  ", p[1], p[2] } }')"
  echo "  $(sed 's/"memory":{//; s/[}"]//g' <<<"$memory" | awk -F, '{ for (i = 1; i <= NF; ++i) { split($i, p, ":"); printf (p[1] ~ /Bytes/ ? "%s %.0f MB  " : ""), p[1], p[2] / 1e6 } }')"
  echo "  peak device memory: $(sed 's/"devicePeak":{//; s/Bytes//g; s/[}"]//g' <<<"$peak" | awk -F, '{ for (i = 1; i <= NF; ++i) { split($i, p, ":"); printf "%s %.0f MB  ", p[1], p[2] / 1e6 } }')"
}

uname -m; nproc
"$bin/quintet_make_large" "$folder/one.glb" --triangles "$triangles"
"$bin/quintet_make_large" "$folder/many.glb" --triangles "$triangles" --meshes 100
"$bin/quintet_make_large" "$folder/textures.glb" --triangles $((triangles / 5)) --meshes 40 --textures 24 --texture-size 2048 --normal-maps
"$bin/quintet_make_large" "$folder/small.glb" --triangles 5000 --textures 1 --texture-size 256
for scene in one many textures; do
  render "$scene, caches empty" "$folder/$scene.glb" "$scene"
  for run in 1 2; do render "$scene, warm" "$folder/$scene.glb" "$scene"; done
done
render "small, caches empty" "$folder/small.glb" small
for run in 1 2 3 4 5; do [ "$run" = 1 ] || QUIET=1; render "small, warm" "$folder/small.glb" small; done
