// SPDX-License-Identifier: Apache-2.0
// What Slurm knows about the tasks of a plan: from squeue, and from sacct where the cluster keeps accounts.
#ifndef QUINTET_FARM_SLURM_TASKS_H
#define QUINTET_FARM_SLURM_TASKS_H

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "farm/plan.h"

namespace quintet::farm {

struct SlurmTask {
  std::string state;  // of Slurm: "RUNNING", "PENDING", "NODE_FAIL"
  std::string nodes;  // empty if it has not started
};

struct SlurmTasks {
  std::string job;            // id of the array; empty if the plan was not submitted
  std::size_t arraySize = 0;  // number of its tasks as submitted; 0 if unknown. Slurm forgets tasks that ended
  std::map<std::size_t, SlurmTask> tasks;  // by their index in the array
  std::optional<SlurmTask> merge;
  std::string problem;  // why nothing is known: squeue is missing or failed; empty if it answered
};

// Reads lines "12_3|RUNNING|node7" and "12|PENDING|", of jobs that have no tasks; other lines are skipped. Lines of tasks
// that are already known do not replace them.
void readTaskLines(std::string_view text, const std::string& renderJob, const std::string& mergeJob, SlurmTasks& tasks);

// Asks Slurm about the jobs that submit.sh started for this plan.
SlurmTasks querySlurm(const Plan& plan);

}  // namespace quintet::farm
#endif
