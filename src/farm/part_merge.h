// SPDX-License-Identifier: Apache-2.0
// The finished parts of a plan become the film of one render.
#ifndef QUINTET_FARM_PART_MERGE_H
#define QUINTET_FARM_PART_MERGE_H

#include <cstddef>
#include <string>

#include "farm/plan.h"
#include "job/observer.h"
#include "job/result.h"

namespace quintet::farm {

// Verifies all parts, and merges them block by block (job::merge) while their checksums are verified. `partial`: without
// the parts that are missing or incomplete. Throws Error that names the unusable parts. `commandLine`, `maxMemory`: as of
// job::merge(). For plans of an image.
job::RenderResult mergeParts(const Plan& plan, bool partial, job::Observer& observer, const std::string& commandLine,
                             std::size_t maxMemory);

}  // namespace quintet::farm
#endif
