#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Made by 'quintet farm plan': submits the job array and the merge job to Slurm. Options of sbatch can be given:
#   ./submit.sh --partition=gpu
# Parts that are done are skipped, so that this can be repeated after a failure. The merge job starts when the array has
# ended, whatever happened to its tasks, because it reports the parts that are not usable.
set -euo pipefail
CDPATH='' cd -- "$(dirname -- "$0")"
if ! command -v sbatch > /dev/null; then
  echo "submit.sh: sbatch was not found: run this where Slurm is installed, or use parallel.sh" >&2
  exit 1
fi
render=$(sbatch --parsable "$@" render.sbatch)
render=${render%%;*}
echo "render $render" > @JOBS@
echo "tasks @TASKS@" >> @JOBS@
merge=$(sbatch --parsable --dependency="afterany:$render" "$@" merge.sbatch)
merge=${merge%%;*}
echo "merge $merge" >> @JOBS@
echo "job array $render renders, job $merge merges; 'quintet farm status .' shows their state"
