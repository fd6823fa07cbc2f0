// SPDX-License-Identifier: Apache-2.0
// Checks raw SPIR-V modules of other applications, as `quintet check --spirv` does: from GLSL, HLSL, Slang or written by
// hand, with or without a description of their groups. The result is data; a front end presents it.
#ifndef QUINTET_JOB_MODULE_CHECKS_H
#define QUINTET_JOB_MODULE_CHECKS_H

#include <filesystem>
#include <string>
#include <vector>

#include "job/program_checks.h"

namespace quintet::job {

struct ModuleCheckRequest {
  // SPIR-V files, and folders, which stand for all SPIR-V files in them and their subfolders.
  std::vector<std::string> modules;
  // groups.json (docs/layer.md). Empty: the files in each folder, and those that are named, form one pipeline each, of which
  // only the stages are known.
  std::filesystem::path groups;
  std::string device;  // whose limits and driver defects count: limitsOfDevice(); empty for limits that hold everywhere
  bool describe = false;  // also describe how the shaders connect: ProgramReport::model
};

// Returns a report per pipeline. A file that cannot be read and a mistake in groups.json are diagnostics. A module with
// capabilities that SPIRV-Tools does not know is a note, and the rules that need it are left out. Throws
// gpu::NoDeviceError.
CheckReport checkModuleFiles(const ModuleCheckRequest& request, CheckObserver& observer);

}  // namespace quintet::job
#endif
