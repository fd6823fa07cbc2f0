// SPDX-License-Identifier: Apache-2.0
// Groups of raw modules without a description: only what their stages say.
#ifndef QUINTET_CHECK_MODULES_STAGE_GROUPS_H
#define QUINTET_CHECK_MODULES_STAGE_GROUPS_H

#include <span>

#include "check/pipeline_graph.h"

namespace quintet::check {

// Any index can select any stage. Which stages form a hit group is unknown (PipelineGroups::groupsKnown), except that one
// closest-hit shader belongs to at most one any-hit and one intersection shader if there are no others.
PipelineGroups groupsOfStages(std::span<const ModuleStage> stages);

}  // namespace quintet::check
#endif
