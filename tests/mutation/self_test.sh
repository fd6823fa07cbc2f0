#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests of tests/mutation/run in a temporary tree with a fake test binary. Needs no build and no device.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$scratch"/{tests/mutation,shaders,programs,bin}
cp "$here/run" "$scratch/tests/mutation"
printf 'one\ntwo\ntwo\nthree\n' > "$scratch/shaders/a.glsl"
# Behaves as the text of the shader says: fails a test, hangs, hangs only once, or crashes.
cat > "$scratch/bin/quintet_gpu_tests" << 'END'
#!/usr/bin/env bash
if grep -q BUG "$QUINTET_SHADER_PATH/a.glsl"; then echo "[  FAILED  ] Some.Test"; exit 1; fi
if grep -q HANG "$QUINTET_SHADER_PATH/a.glsl"; then sleep 60; fi
if grep -q SLOW "$QUINTET_SHADER_PATH/a.glsl"; then
  if [ ! -f "$0.seen" ]; then touch "$0.seen"; sleep 60; fi
  echo "[  FAILED  ] Some.Test"; exit 1
fi
if grep -q CRASH "$QUINTET_SHADER_PATH/a.glsl"; then exit 139; fi
END
chmod +x "$scratch/bin/quintet_gpu_tests"

failed=0
# entry NAME OLD NEW [FILE]: appends an entry to the table of the next `expect`.
entry() { printf '[%s]\nfile %s\nold %s\nnew %s\ntests gpu Some.*\n' "$1" "${4-shaders/a.glsl}" "$2" "$3" >> "$scratch/table"; }
# expect STATUS TEXT ARGUMENT...: runs the script with the table, checks status and output, and removes the table.
expect() {
  local wanted=$1 text=$2 output status=0
  shift 2
  output=$("$scratch/tests/mutation/run" "$@" --table "$scratch/table" 2>&1) || status=$?
  rm "$scratch/table"
  if [ "$status" = "$wanted" ] && grep -q -e "$text" <<< "$output"; then return; fi
  printf 'status %s, expected %s with "%s":\n%s\n---\n' "$status" "$wanted" "$text" "$output"
  failed=$((failed + 1))
}
bin=$scratch/bin

entry fine one BUG;                 expect 0 '1 texts, each found once' --texts
entry gone four BUG;                expect 2 '\[gone\] shaders/a.glsl: text not found' --texts
entry twice two BUG;                expect 2 '\[twice\] shaders/a.glsl: text found more than once' --texts
entry spaces 'two two' BUG;         expect 0 '1 texts, each found once' --texts
entry after two BUG; echo 'after one' >> "$scratch/table"; expect 0 '1 texts, each found once' --texts
entry after one BUG; echo 'after two' >> "$scratch/table"; expect 2 '\[after\] shaders/a.glsl: text not found' --texts
entry at two BUG; echo 'at 3 1' >> "$scratch/table"; expect 0 '1 texts, each found once' --texts
entry at two BUG; echo 'at 4 1' >> "$scratch/table"; expect 2 '\[at\] shaders/a.glsl: text not found at line 4' --texts
entry at two BUG; echo 'at 3 1' >> "$scratch/table"; expect 0 '^at .* caught ' "$bin"
entry nowhere one BUG shaders/b;    expect 2 '\[nowhere\] shaders/b: no such file' --texts
mkdir -p "$scratch/src"; echo one > "$scratch/src/a.h"; echo one > "$scratch/notes.md"
entry header one BUG src/a.h;       expect 2 "\[header\] src/a.h: a header needs a line 'source FILE'" --texts
entry header one BUG src/a.h; echo 'source src/a.cpp' >> "$scratch/table"; expect 0 '1 texts, each found once' --texts
entry other one BUG notes.md;       expect 2 '\[other\] notes.md: neither a source nor in shaders/ or programs/' --texts
entry fine one BUG; entry gone four BUG; expect 2 '1 of 2 entries cannot be seeded' "$bin"
entry fine one BUG;                 expect 0 '^fine .* caught  *Some.Test' "$bin"
entry unseen one 1;                 expect 1 '^unseen .* SURVIVED' "$bin"
entry crash one CRASH;              expect 1 '^crash .* INVALID  *exit status 139' "$bin"
entry hangs one HANG;               expect 1 '^hangs .* TIMEOUT ' "$bin" --limit 1
entry slow one SLOW; entry fine three BUG; expect 0 '^slow .* caught  *Some.Test' "$bin" --limit 2
entry hangs one HANG; entry fine three BUG; expect 1 '^1 of 2 seeded bugs caught' "$bin" --limit 1
[ "$failed" = 0 ] && echo "tests/mutation/run: all as expected"
