// SPDX-License-Identifier: Apache-2.0
// Why the last attempt at a part failed: a small file beside the part, so that the status and the merge can report the cause
// without the logs of the machine. A finished part removes it.
#ifndef QUINTET_FARM_PART_FAILURE_H
#define QUINTET_FARM_PART_FAILURE_H

#include <cstddef>
#include <optional>
#include <string>

#include "farm/plan.h"

namespace quintet::farm {

struct PartFailure {
  std::string machine;
  std::string message;  // empty if status is 0
  int status = 0;       // of the process; 0 if it was started and has neither finished the part nor reported an error
};

std::string machineName();  // of this machine

// Does nothing if the file cannot be written, for example because the disk is full: the log has the message, too.
void recordFailure(const Plan& plan, std::size_t part, const PartFailure& failure);
void removeFailure(const Plan& plan, std::size_t part);
std::optional<PartFailure> readFailure(const Plan& plan, std::size_t part);  // unset if there is none that can be read

}  // namespace quintet::farm
#endif
