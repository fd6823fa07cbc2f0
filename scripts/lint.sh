#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Checks the format of C++ (clang-format 14, because other versions format differently) and the scripts (shellcheck).
#   lint.sh        checks C++ and scripts with the installed tools
#   lint.sh --cpp  checks only C++
#   lint.sh --fix  formats C++, then checks the scripts
# Exit status: 1 for problems, 77 if no tool is installed.
# The headers below shaders/, which C++ and GLSL share, are formatted by hand.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit

status=77
check() {  # LABEL COMMAND…
  local label=$1
  shift
  if "$@"; then
    echo "lint: $label: ok"
    [ "$status" = 1 ] || status=0
  else
    echo "lint: $label: problems found"
    status=1
  fi
}

clang_format=
for name in clang-format-14 clang-format; do
  if command -v "$name" >/dev/null && [[ $("$name" --version) =~ version\ 14\. ]]; then
    clang_format=$name
    break
  fi
done
mapfile -d '' sources < <(find apps examples include src tests \( -name '*.cpp' -o -name '*.h' \) -print0)
if [ -z "$clang_format" ]; then
  echo "lint: C++ not checked, clang-format 14 is not installed"
elif [ "${1-}" = --fix ]; then
  check "C++ formatted" "$clang_format" -i "${sources[@]}"
else
  check "C++ format" "$clang_format" --dry-run -Werror "${sources[@]}"
fi

[ "${1-}" = --cpp ] && exit "$status"
if command -v shellcheck >/dev/null; then
  check "scripts" shellcheck -x scripts/*.sh tests/setup/*.sh tests/mutation/run tests/mutation/*.sh tests/bench/*.sh .ci/run
else
  echo "lint: scripts not checked, shellcheck is not installed"
fi
exit "$status"
