#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Disassembles the shaders that a command compiles, and validates them with spirv-val:
#
#   scripts/spirv.sh FOLDER COMMAND…     for example: scripts/spirv.sh spirv quintet run lessons/05_shadow
#
# The command runs with an empty cache of shaders, and also compiles those that the binary contains. Each shader is written as
# FOLDER/NAME.spv and FOLDER/NAME.spvasm; the names are those of the files. Requires spirv-dis and spirv-val (package
# spirv-tools).
set -euo pipefail
if (($# < 2)); then
    sed -n '3,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}" >&2
    exit 2
fi
folder=$1
shift
mkdir -p "$folder"
cache=$(mktemp -d)
trap 'rm -rf "$cache"' EXIT
result=0
QUINTET_NO_SHIPPED_SHADERS=1 QUINTET_CACHE_DIR=$cache "$@" || result=$?

# Prints the 32-bit word at a byte offset of a file.
word() { od -An -v -tu4 -j "$2" -N 4 "$1" | tr -d ' '; }

# The format of src/shader/spirv_cache.cpp: a header of 40 bytes, the number of words, the words, diagnostics.
count=0
for file in "$cache"/shaders/*.qspv; do
    [ -e "$file" ] || break
    if [ "$(word "$file" 44)" != $((0x07230203)) ]; then
        echo "spirv.sh: $file: unknown format" >&2
        exit 1
    fi
    tail -c +45 "$file" | head -c $(($(word "$file" 40) * 4)) >"$cache/shader.spv" || true
    # The first OpString is the name of the shader.
    spirv-dis --raw-id "$cache/shader.spv" >"$cache/shader.spvasm"
    name=$(sed -n 's/^ *%[0-9]* = OpString "\(.*\)"$/\1/p' "$cache/shader.spvasm" | sed -n 1p)
    name=${name##*/}
    # Large modules have two entries: for the source, and for the output of glslang.
    cmp -s "$cache/shader.spv" "$folder/$name.spv" && continue
    [ ! -e "$folder/$name.spv" ] || name+=.$(basename "$file" .qspv)
    mv "$cache/shader.spv" "$folder/$name.spv"
    mv "$cache/shader.spvasm" "$folder/$name.spvasm"
    spirv-val --target-env vulkan1.3 --scalar-block-layout "$folder/$name.spv" || result=1
    echo "$folder/$name.spvasm"
    count=$((count + 1))
done
[ "$count" -gt 0 ] || { echo "spirv.sh: the command compiled no shader" >&2; exit 1; }
exit "$result"
