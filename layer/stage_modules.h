// SPDX-License-Identifier: Apache-2.0
// The modules of a pipeline for the check: optimized, with one name each. The same entry point of the same SPIR-V with the same
// constants is one module, however often the pipeline has it as a stage: engines create a stage for each of thousands of hit
// groups.
#ifndef QUINTET_LAYER_STAGE_MODULES_H
#define QUINTET_LAYER_STAGE_MODULES_H

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "check/modules/stage_module.h"
#include "check/pipeline_graph.h"
#include "module_cache.h"

namespace quintet::layer {

struct StageCopy;

struct StageModules {
  std::vector<check::ModuleStage> modules;
  std::vector<std::uint64_t> recordBytes;      // by module: of its shader record block
  bool indexByRecord = false;                  // a module has an index that depends on the data of its record
  std::vector<std::size_t> ofStage;            // index in `modules`, by stage
  std::map<std::string, std::string> sources;  // texts by file

  const check::ModuleStage& of(std::size_t stage) const { return modules[ofStage[stage]]; }
};

// `loop(count, body)` calls the body for each number below the count.
using ParallelLoop = std::function<void(std::size_t, const std::function<void(std::size_t)>&)>;
StageModules modulesOf(const std::vector<StageCopy>& stages, ModuleCache& cache, const ParallelLoop& loop);

}  // namespace quintet::layer
#endif
