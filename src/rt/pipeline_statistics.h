// What a driver tells of a pipeline: registers, stack, code size of its executables
// (VK_KHR_pipeline_executable_properties), and the stack of its shader groups.
#ifndef QUINTET_RT_PIPELINE_STATISTICS_H
#define QUINTET_RT_PIPELINE_STATISTICS_H

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "rt/pipeline.h"

namespace quintet::rt {

// One piece of machine code. What is counted and how it is called is the driver's choice.
struct PipelineExecutable {
  std::string name;
  std::uint32_t subgroupSize = 0;
  std::vector<std::pair<std::string, double>> statistics;
};

// Empty where the device has no DeviceInfo::pipelineStatistics, or the pipeline was made without captureStatistics.
std::vector<PipelineExecutable> pipelineStatistics(const Pipeline& pipeline);

// Bytes of stack that one call of a group's shader takes, by the groups' names: the largest of a group's shaders.
std::vector<std::pair<std::string, std::uint64_t>> groupStackSizes(const Pipeline& pipeline);

}  // namespace quintet::rt
#endif
