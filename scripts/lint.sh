#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Checks the format of C++ (clang-format 14, because other versions format differently) and all scripts (shellcheck).
#   lint.sh              checks everything with the installed tools
#   lint.sh --fix        formats C++, then checks
#   lint.sh --cpp        checks only C++
#   lint.sh --scripts    checks only the scripts
#   lint.sh --tidy [FILE…]   runs clang-tidy 14 on the C++ sources (default: all; slow) with build/release
#   lint.sh --files FILE…    checks only these; files that are neither C++ nor scripts do not count
#   lint.sh --changed [COMMIT]   checks the files that differ from COMMIT (default: HEAD), and runs clang-tidy on the sources among
#                        them and on one source for each header
# Exit status: 1 for problems, 77 if no tool is installed. With CI=true a tool that apt can install must be installed.
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

# missing LABEL PACKAGE: reports a missing tool. In CI it is an error, unless the system does not have the package.
missing() {
  if [ "${CI-}" = true ] && [ -n "$(apt-cache show "$2" 2>/dev/null)" ]; then
    echo "lint: $1: error: $2 is not installed; run: bash scripts/setup.sh lint"
    status=1
  else
    echo "lint: $1: not checked, $2 is not installed"
  fi
}

# version14 NAME: prints the path of version 14 of a tool of LLVM, if it is installed.
version14() {
  local name
  for name in "$1-14" "$1"; do
    if command -v "$name" >/dev/null && [[ $("$name" --version) =~ version\ 14\. ]]; then
      command -v "$name"
      return
    fi
  done
}

# checkCpp [--fix] [FILE…]: default: all.
checkCpp() {
  local tool fix=""
  [ "${1-}" != --fix ] || { fix=--fix; shift; }
  tool=$(version14 clang-format)
  (($#)) || { mapfile -d '' sources < <(find apps examples include layer src tests \( -name '*.cpp' -o -name '*.h' \) -print0); set -- "${sources[@]}"; }
  if [ -z "$tool" ]; then
    missing "C++ format" clang-format-14
  elif [ -n "$fix" ]; then
    check "C++ formatted" "$tool" -i "$@"
  else
    check "C++ format" "$tool" --dry-run -Werror "$@"
  fi
}

# checkScripts [FILE…]: those of the files (default: all) that begin like a shell script, so that a new script is checked at once.
checkScripts() {
  local scripts=() all=(.ci scripts tests)
  (($#)) || set -- "${all[@]}"
  mapfile -t scripts < <(find "$@" -type f -size -200k -exec \
    awk 'FNR == 1 && /^#!.*[\/ ](ba)?sh$/ || FNR < 4 && /^# shellcheck shell=/ { print FILENAME } FNR > 3 { nextfile }' {} + | sort -u)
  ((${#scripts[@]})) || return 0
  if command -v shellcheck >/dev/null; then
    check "scripts" shellcheck -x "${scripts[@]}"
  else
    missing scripts shellcheck
  fi
}

checkTidy() {
  local tool files=("$@")
  tool=$(version14 clang-tidy)
  ((${#files[@]})) || mapfile -t files < <(find apps examples layer src -name '*.cpp' | sort)
  if [ -z "$tool" ]; then
    missing clang-tidy clang-tidy-14
  elif [ ! -e build/release/compile_commands.json ]; then
    echo "lint: clang-tidy: no build/release/compile_commands.json; run: make build"
    status=1
  else
    # The compile commands are those of GCC, with precompiled headers that clang cannot read.
    mkdir -p build/tidy
    sed 's/ -include [^ ]*cmake_pch\.hxx//; s/ -Winvalid-pch//; s/ -fpch-preprocess//' build/release/compile_commands.json \
      >build/tidy/compile_commands.json
    # shellcheck disable=SC2016  # the inner shell expands the variable
    check clang-tidy xargs -P "$(nproc)" -n 1 "$tool" -p build/tidy --quiet --extra-arg=-Wno-unknown-warning-option < <(printf '%s\n' "${files[@]}")
  fi
}

# changedFiles COMMIT: prints the files that differ from COMMIT. Files that git does not know yet count, too.
changedFiles() {
  git diff --name-only --diff-filter=d "$1"
  git ls-files --others --exclude-standard
}

# checkFiles FILE…: the format of C++ and the scripts among the files.
checkFiles() {
  local cpp=()
  mapfile -t cpp < <(printf '%s\n' "$@" | grep -E '^(apps|examples|include|layer|src|tests)/.*\.(cpp|h)$')
  ((${#cpp[@]} == 0)) || checkCpp "${cpp[@]}"
  (($# == 0)) || checkScripts "$@"
}

# changedSources COMMIT: prints the sources that differ from COMMIT, and for each header that differs its own source, or else the
# first one that includes it.
changedSources() {
  local file
  changedFiles "$1" | while read -r file; do
    case $file in
      apps/*.cpp | examples/*.cpp | layer/*.cpp | src/*.cpp) echo "$file" ;;
      apps/*.h | include/*.h | layer/*.h | src/*.h)
        if [ -e "${file%.h}.cpp" ]; then echo "${file%.h}.cpp"
        else grep -rlF --include='*.cpp' "#include \"${file#*/}\"" apps examples layer src | sort | head -n 1; fi ;;
    esac
  done | sort -u
}

checkChanged() {
  local files
  git rev-parse --verify --quiet "$1^{commit}" >/dev/null || { echo "lint: no commit $1" >&2; exit 2; }
  mapfile -t files < <(changedFiles "$1")
  checkFiles "${files[@]}"
  mapfile -t files < <(changedSources "$1")
  if ((${#files[@]})); then checkTidy "${files[@]}"; else echo "lint: clang-tidy: no source has changed"; fi
}

case ${1-} in
  '' | --fix) checkCpp "$@"; checkScripts ;;
  --cpp) checkCpp ;;
  --scripts) checkScripts ;;
  --tidy) shift; checkTidy "$@" ;;
  --files) shift; checkFiles "$@"; [ "$status" != 77 ] || status=0 ;;
  --changed) checkChanged "${2-HEAD}" ;;
  *) sed -n '3,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
esac
exit "$status"
