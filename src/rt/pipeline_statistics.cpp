#include "rt/pipeline_statistics.h"

#include <algorithm>

#include "gpu/error.h"

namespace quintet::rt {
namespace {

double asNumber(const VkPipelineExecutableStatisticKHR& statistic) {
  switch (statistic.format) {
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_BOOL32_KHR: return statistic.value.b32 ? 1.0 : 0.0;
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_INT64_KHR: return static_cast<double>(statistic.value.i64);
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_UINT64_KHR: return static_cast<double>(statistic.value.u64);
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_FLOAT64_KHR: return statistic.value.f64;
    default: return 0.0;
  }
}

std::vector<VkPipelineExecutableStatisticKHR> statisticsOf(const gpu::Context& context, VkPipeline pipeline,
                                                           std::uint32_t executable) {
  VkPipelineExecutableInfoKHR info{VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR};
  info.pipeline = pipeline;
  info.executableIndex = executable;
  std::uint32_t count = 0;
  gpu::check(context.vk().vkGetPipelineExecutableStatisticsKHR(context.device(), &info, &count, nullptr),
             "count a pipeline's statistics");
  std::vector<VkPipelineExecutableStatisticKHR> statistics(count,
                                                           {VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR});
  gpu::check(context.vk().vkGetPipelineExecutableStatisticsKHR(context.device(), &info, &count, statistics.data()),
             "get a pipeline's statistics");
  return statistics;
}

}  // namespace

std::vector<PipelineExecutable> pipelineStatistics(const Pipeline& pipeline) {
  const gpu::Context& context = pipeline.context();
  if (!pipeline.keepsStatistics()) return {};
  VkPipelineInfoKHR info{VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR};
  info.pipeline = pipeline.handle();
  std::uint32_t count = 0;
  gpu::check(context.vk().vkGetPipelineExecutablePropertiesKHR(context.device(), &info, &count, nullptr),
             "count a pipeline's executables");
  std::vector<VkPipelineExecutablePropertiesKHR> properties(count,
                                                            {VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR});
  gpu::check(context.vk().vkGetPipelineExecutablePropertiesKHR(context.device(), &info, &count, properties.data()),
             "list a pipeline's executables");
  std::vector<PipelineExecutable> executables;
  for (std::uint32_t i = 0; i < count; ++i) {
    PipelineExecutable& executable = executables.emplace_back();
    executable.name = properties[i].name;
    executable.subgroupSize = properties[i].subgroupSize;
    for (const VkPipelineExecutableStatisticKHR& statistic : statisticsOf(context, pipeline.handle(), i))
      executable.statistics.emplace_back(statistic.name, asNumber(statistic));
  }
  return executables;
}

std::vector<std::pair<std::string, std::uint64_t>> groupStackSizes(const Pipeline& pipeline) {
  const gpu::Context& context = pipeline.context();
  std::vector<std::pair<std::string, std::uint64_t>> sizes;
  for (std::uint32_t i = 0; i < pipeline.groups().size(); ++i) {
    const PipelineGroup& group = pipeline.groups()[i];
    std::uint64_t size = 0;
    const auto ask = [&](int stage, VkShaderGroupShaderKHR shader) {
      if (stage != kNoStage)
        size = std::max<std::uint64_t>(
            size, context.vk().vkGetRayTracingShaderGroupStackSizeKHR(context.device(), pipeline.handle(), i, shader));
    };
    ask(group.general, VK_SHADER_GROUP_SHADER_GENERAL_KHR);
    ask(group.closestHit, VK_SHADER_GROUP_SHADER_CLOSEST_HIT_KHR);
    ask(group.anyHit, VK_SHADER_GROUP_SHADER_ANY_HIT_KHR);
    ask(group.intersection, VK_SHADER_GROUP_SHADER_INTERSECTION_KHR);
    sizes.emplace_back(group.name, size);
  }
  return sizes;
}

}  // namespace quintet::rt
