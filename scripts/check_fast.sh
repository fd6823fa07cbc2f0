#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The checks that a change passes in less than a minute: architecture, style, format of the changed files, and the short unit
# tests of the layers that differ from COMMIT (default: HEAD).
#   check_fast.sh [COMMIT]
# Compiles the unit tests first, which takes longer if a header changed that many files include. Exit status: 1 for problems.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
commit=${1-HEAD}
git rev-parse --verify --quiet "$commit^{commit}" >/dev/null || { echo "check_fast: no commit $commit" >&2; exit 2; }
[ -e build/release/build.ninja ] || { echo "check_fast: no build/release; run: make build" >&2; exit 2; }
jobs=${JOBS-$(nproc)}
mapfile -t changed < <(git diff --name-only --diff-filter=d "$commit"; git ls-files --others --exclude-standard)

# layers: prints the layers of the changed files, one per line. Tests mirror the sources.
layers() {
  printf '%s\n' "${changed[@]}" | sed -nE 's#^(src|tests/unit)/([a-z]+)/.*#\2#p' | sort -u
}

status=0
begin=$SECONDS
ctest --preset release --output-on-failure --no-tests=error -j "$jobs" \
  -R '^(architecture\.(includes|standard_headers|options)|docs\.(style|links|names|excerpts)|style\.license)$' || status=1
scripts/lint.sh --files "${changed[@]}" || status=1
checked=$((SECONDS - begin))

pattern=$(layers | paste -sd '|')
if [ -z "$pattern" ]; then
  echo "check_fast: no layer has changed"
else
  begin=$SECONDS
  cmake --build --preset release -j "$jobs" --target quintet_unit_tests || exit 1
  built=$((SECONDS - begin)) begin=$SECONDS
  ctest --preset release --output-on-failure -j "$jobs" -L "^layer-($pattern)\$" -L '^unit$' -LE '^(mutation|long|nightly)$' || status=1
  echo "check_fast: ${pattern//|/, }: $built s to build, $((SECONDS - begin)) s of tests"
fi
echo "check_fast: $checked s of other checks; exit status $status"
exit "$status"
