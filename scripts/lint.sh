#!/usr/bin/env bash
# The layout of C++ (clang-format 14: other versions lay out differently) and the scripts (shellcheck).
#   lint.sh        checks with what is installed and says what is not
#   lint.sh --cpp  checks only the C++
#   lint.sh --fix  lays out the C++
# Exit status: 1 if something is not as it should be, 77 if neither tool is installed.
# The headers below shaders/ are read by C++ too, and laid out by hand, side by side with their GLSL.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit

status=77
check() {  # LABEL COMMAND…
  local label=$1
  shift
  if "$@"; then
    echo "lint: $label fine"
    [ "$status" = 1 ] || status=0
  else
    echo "lint: $label not fine"
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
  echo "lint: no clang-format 14 here, C++ not checked"
elif [ "${1-}" = --fix ]; then
  check "C++ is now" "$clang_format" -i "${sources[@]}"
else
  check "C++ is" "$clang_format" --dry-run -Werror "${sources[@]}"
fi

[ "${1-}" = --cpp ] && exit "$status"
if command -v shellcheck >/dev/null; then
  check "scripts are" shellcheck -x scripts/*.sh tests/setup/*.sh tests/mutation/run tests/mutation/*.sh tests/bench/*.sh .ci/run
else
  echo "lint: no shellcheck here, scripts not checked"
fi
exit "$status"
