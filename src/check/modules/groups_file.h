// SPDX-License-Identifier: Apache-2.0
// groups.json: which raw SPIR-V modules form which shader groups, in the order of the shader binding table (docs/layer.md).
#ifndef QUINTET_CHECK_MODULES_GROUPS_FILE_H
#define QUINTET_CHECK_MODULES_GROUPS_FILE_H

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "check/pipeline_groups.h"
#include "shader/optimizer.h"

namespace quintet::check {

// A stage that a groups file names: a module, and an entry point that can be missing if the module has one.
struct StageName {
  std::string module;
  std::string entryPoint;  // empty for the only one
  std::string pointer;     // JSON pointer, for messages
};

struct DescribedPipeline {
  std::string name;  // empty if the file does not name it
  // The stages are the keys of `stages`.
  PipelineGroups groups;
  std::map<std::string, StageName> stages;
  // By module; a module without values has unknown specialization constants.
  std::map<std::string, shader::SpecializationValues> specialization;
};

// Throws FileError with the JSON pointer of what is wrong.
std::vector<DescribedPipeline> parseGroups(const std::filesystem::path& file, std::string_view text);

}  // namespace quintet::check
#endif
