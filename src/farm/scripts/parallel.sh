#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# shellcheck disable=SC2154  # run_part.sh assigns them
# Made by 'quintet farm plan': runs the plan with GNU parallel and merges its parts. Options of parallel can be given:
#   ./parallel.sh --sshlogin 1/node1,1/node2     one part at a time on each of two machines, over SSH
#   ./parallel.sh --jobs 1                       on this machine
# All machines must reach the folders of the plan and of the scene under the same names. Parts that are done are skipped,
# so that this can be repeated after a failure.
set -uo pipefail
@RUN_PART@
if [[ ${1-} == --part ]]; then  # on one of the machines
  run_part "$2"
  exit
fi
CDPATH='' cd -- "$(dirname -- "$0")" || exit 1
if ! command -v parallel > /dev/null; then
  echo "parallel.sh: GNU parallel was not found" >&2
  exit 1
fi
# As an argument, the path of this script is quoted for the shells of the machines.
seq 0 @LAST_PART@ | parallel --retries 3 --joblog logs/parallel.log "$@" bash '{1}' --part '{2}' ::: @PARALLEL@ :::: -
exec "$quintet" farm merge "$plan"
