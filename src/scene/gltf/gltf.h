// SPDX-License-Identifier: Apache-2.0
// Loads glTF 2.0 files (.gltf and .glb, recognized by content). docs/gltf.md specifies the conversion.
#ifndef QUINTET_SCENE_GLTF_GLTF_H
#define QUINTET_SCENE_GLTF_GLTF_H

#include <filesystem>
#include <memory>

#include "base/memory_budget.h"
#include "scene/load_options.h"
#include "scene/model/scene.h"
#include "scene/pending_scene.h"

namespace quintet::scene {

// Reads everything except image data, using all cores for the meshes. The result is described unless a used image is in
// a separate file or has an invalid header. Throws FileError with the location in the file
// ("/accessors/3/bufferView", "line 3, column 7", "byte 12"), UsageError if options.scene, variant or animation does not
// exist, MemoryError.
// finish() decodes the images on all cores; it throws FileError and MemoryError.
// `budget`: shared with other files; null means one of its own with options.maxMemory.
PendingScene beginLoadingGltf(const std::filesystem::path& file, const LoadOptions& options = {},
                              std::shared_ptr<MemoryBudget> budget = nullptr);

// Both steps.
Scene loadGltf(const std::filesystem::path& file, const LoadOptions& options = {});

}  // namespace quintet::scene
#endif
