// SPDX-License-Identifier: Apache-2.0
// The scripts that run a plan: a Slurm job array and its merge job, their submission, and GNU parallel over SSH. They only
// start 'quintet farm run' and 'quintet farm merge'; everything else is decided there.
#ifndef QUINTET_FARM_SCRIPTS_H
#define QUINTET_FARM_SCRIPTS_H

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "farm/plan.h"

namespace quintet::farm {

// Slurm's default MaxArraySize is 1001, so that 1000 is the largest index.
inline constexpr std::size_t kDefaultTasks = 1000;
inline constexpr const char* kJobsFile =
    "slurm_jobs";  // in the folder of the plan: ids of the submitted jobs, number of tasks

struct ScriptOptions {
  std::filesystem::path program;        // quintet, on all machines
  std::size_t tasks = kDefaultTasks;    // of the job array at most; with more parts a task renders several
  unsigned retries = 2;                 // of a part whose process crashed or was killed
  std::string partition, time, memory;  // of Slurm; empty means its default
  std::vector<std::string> sbatch;      // further options of sbatch: "--gres=gpu:1"
};

// Number of tasks of the job array. Task t renders the parts t, t + tasks, t + 2 · tasks, …
std::size_t taskCount(const Plan& plan, const ScriptOptions& options);

// Names and texts of the scripts, for the folder of the plan. Throws UsageError for options with line breaks.
std::vector<std::pair<std::string, std::string>> scripts(const Plan& plan, const ScriptOptions& options);

// Creates the folders, and writes plan and scripts; the plan last. Throws FileError; with Remedy::overwrite if the folder
// holds a different plan and `overwrite` is false.
void writePlan(const Plan& plan, const ScriptOptions& options, bool overwrite);

}  // namespace quintet::farm
#endif
