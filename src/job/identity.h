// SPDX-License-Identifier: Apache-2.0
// The part of a render's provenance that follows from the program and its parameters.
#ifndef QUINTET_JOB_IDENTITY_H
#define QUINTET_JOB_IDENTITY_H

#include <filesystem>
#include <string>
#include <vector>

#include "base/hash.h"
#include "job/provenance.h"
#include "job/resolve.h"
#include "render/renderer/renderer.h"
#include "scene/model/scene.h"

namespace quintet::job {

// All identity facts but the hashes of scene, environment and program. Images of parameters are hashed by their content.
// Throws FileError.
Provenance identityOf(const ResolvedJob& job, const render::Renderer& renderer, const scene::Camera& camera,
                      uvec2 size);

// Of the descriptions and shaders of a program, and of what they include. Names of folders do not matter.
// `includedFiles`: hashes of the files from outside (program::CompiledProgram::fileHashes).
std::string programHash(const program::Program& program, const std::vector<Hash>& includedFiles);

// Files on disk that the program and its parameters come from, as far as they exist on disk.
std::vector<std::filesystem::path> programFiles(const ResolvedJob& job);

}  // namespace quintet::job
#endif
