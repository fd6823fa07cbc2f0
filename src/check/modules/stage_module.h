// SPDX-License-Identifier: Apache-2.0
// Raw SPIR-V of an application as stages of a pipeline: one stage per entry point, specialized and optimized for the
// analysis. What cannot be analyzed is a normal result with a reason: malformed modules, and valid ones with capabilities
// that SPIRV-Tools does not know.
#ifndef QUINTET_CHECK_MODULES_STAGE_MODULE_H
#define QUINTET_CHECK_MODULES_STAGE_MODULE_H

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "check/pipeline_graph.h"
#include "shader/optimizer.h"
#include "spirv/module.h"

namespace quintet::check {

// What a module is, without its code.
struct ModuleSummary {
  std::vector<spirv::EntryPoint> entryPoints;  // of ray tracing stages
  std::map<std::string, std::string> sources;  // texts that the module contains, by file
};

// Returns the words of a SPIR-V file in the byte order of the host. Throws FileError if it is no SPIR-V.
std::vector<std::uint32_t> moduleWords(const std::string& file, std::span<const std::byte> bytes);

// Returns nullopt if the words are malformed, with the reason in `why`.
std::optional<ModuleSummary> summarize(const std::vector<std::uint32_t>& words, std::string& why);

// Nullopt if the stage does not belong to ray tracing.
std::optional<shader::Stage> stageOf(spv::ExecutionModel model);

// `name` as in PipelineGroups. Without `values`, specialization constants are unknown. Never throws because of the words.
ModuleStage stageModule(const std::string& name, const std::vector<std::uint32_t>& words,
                        const spirv::EntryPoint& entryPoint, const std::optional<shader::SpecializationValues>& values);

}  // namespace quintet::check
#endif
