// SPDX-License-Identifier: Apache-2.0
// The first step of every render: a request becomes a resolved job, or an error that needs no device to be found.
#ifndef QUINTET_JOB_RESOLVE_H
#define QUINTET_JOB_RESOLVE_H

#include <filesystem>
#include <vector>

#include "job/request.h"
#include "job/scene_source.h"
#include "program/description/parameter.h"
#include "program/description/program.h"

namespace quintet::job {

// A request whose program, parameters and files exist and fit together. Plain data; nothing has been loaded or compiled.
struct ResolvedJob {
  RenderRequest request;
  program::Program program;
  program::ParameterValues parameters{{}};
  SceneSource scene;

  bool accumulatesFrames() const { return program.accumulation == program::Accumulation::program; }
};

// Throws UsageError and FileError for everything that can be wrong without scene and device: parameters, limits that the
// program does not support, files that cannot be read or written.
ResolvedJob resolve(RenderRequest request, program::Program program);

// The values of the program's parameters: defaults, then the file, then the assignments. Throws UsageError, FileError.
program::ParameterValues parameterValues(const program::Program& program, const RenderRequest& request);

// True for a file name that a program's folder is watched for: shaders and descriptions, not the images written there.
bool isProgramSource(const std::filesystem::path& name);

}  // namespace quintet::job
#endif
