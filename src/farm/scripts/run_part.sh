# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
quintet=@PROGRAM@
plan=@PLAN@
retries=@RETRIES@

# Renders a part, and again if its process crashed or was killed: its checkpoint continues. Other errors would only repeat.
run_part() {
  local attempt result
  for ((attempt = 0; ; ++attempt)); do
    result=0
    "$quintet" farm run --quiet "$plan" "$1" || result=$?
    case $result in
      0) return 0 ;;
      4 | 134 | 135 | 136 | 137 | 139) ;;
      *) return "$result" ;;
    esac
    if ((attempt >= retries)); then return "$result"; fi
    echo "part $1: status $result; attempt $((attempt + 2)) of $((retries + 1))" >&2
  done
}
