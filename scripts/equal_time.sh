#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Compares the error of two builds of quintet at equal time, on the scenes of tests/bench/scenes.txt.
#
#   scripts/equal_time.sh A B [OPTION…]         A and B are quintet binaries; see quintet_equal_time --help
#   scripts/equal_time.sh --pack FOLDER A B     pack everything for another machine; run FOLDER/run [OPTION…] there
#
# Environment: BUILD  folder of quintet_equal_time and quintet_make_scenes (default: build/release/bin). Configure it with
#                     -DQUINTET_BENCHMARKS=ON.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${BUILD:-$root/build/release/bin}

usage() {
    sed -n '3,9s/^# \?//p' "${BASH_SOURCE[0]}" >&2
    exit 2
}

makeScenes() {  # FOLDER
    "$build/quintet_make_scenes" "$1"
    cp "$root/tests/bench/scenes.txt" "$1"
}

# Copies a binary without debug information, and the libraries that a minimal system lacks.
addBinary() {  # BINARY FOLDER NAME
    strip -o "$2/$3" "$1"
    ldd "$1" | awk '/=> \//{print $3}' | grep -vE '/(libc|libm|libpthread|libdl|librt|ld-linux)[.-]' |
        while read -r library; do cp -Lu "$library" "$2/lib/"; done
}

pack() {  # FOLDER A B
    local folder=$1
    mkdir -p "$folder/lib" "$folder/scenes"
    addBinary "$2" "$folder" a
    addBinary "$3" "$folder" b
    addBinary "$build/quintet_equal_time" "$folder" equal_time
    makeScenes "$folder/scenes"
    rm -f "$folder"/scenes/{furnace,plane_light}.glb
    cat >"$folder/run" <<'END'
#!/usr/bin/env bash
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export LD_LIBRARY_PATH=$here/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
exec "$here/equal_time" "$here/a" "$here/b" --scenes "$here/scenes" "$@"
END
    chmod +x "$folder/run"
}

if [ "${1:-}" = --pack ]; then
    [ $# -eq 4 ] || usage
    pack "$2" "$3" "$4"
    exit
fi
[ $# -ge 2 ] || usage
scenes=$(mktemp -d)
trap 'rm -rf "$scenes"' EXIT
makeScenes "$scenes"
"$build/quintet_equal_time" "$@" --scenes "$scenes"
