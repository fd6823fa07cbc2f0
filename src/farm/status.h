// SPDX-License-Identifier: Apache-2.0
// The state of all parts of a plan, with what Slurm knows of them, as a table and as JSON.
#ifndef QUINTET_FARM_STATUS_H
#define QUINTET_FARM_STATUS_H

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "farm/part_check.h"
#include "farm/slurm_tasks.h"

namespace quintet::farm {

struct Status {
  Plan plan;
  std::vector<PartCheck> parts;
  std::vector<std::filesystem::path> unexpected;  // unexpectedFiles()
  SlurmTasks slurm;
  std::size_t tasks = 0;  // of the job array

  std::array<std::size_t, kPartStates> counts() const;  // by PartState
  bool complete() const;                                // all parts are usable
};

Status readStatus(const Plan& plan, CheckDepth depth);

// A line with the counts, one for each part that is not done (at most `rows`), and what Slurm reports.
std::string statusText(const Status& status, std::size_t rows = 20);
// One object on one line, with each part that is not done.
std::string statusJson(const Status& status);

}  // namespace quintet::farm
#endif
