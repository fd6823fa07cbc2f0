// SPDX-License-Identifier: Apache-2.0
// Loads glTF 2.0 files (.gltf and .glb, recognized by content). docs/gltf.md specifies the conversion.
#ifndef QUINTET_SCENE_GLTF_GLTF_H
#define QUINTET_SCENE_GLTF_GLTF_H

#include <filesystem>
#include <string>

#include "scene/model/scene.h"
#include "scene/pending_scene.h"

namespace quintet::scene {

struct GltfOptions {
  // Index of the file's scene to load. kNone means its default scene, else its first scene, else all root nodes.
  int scene = kNone;
  std::string variant;  // name of a material variant of the file; empty means the materials of the primitives
};

// Reads everything except image data, using all cores for the meshes. The result is described unless a used image is in
// a separate file or has an invalid header. Throws FileError with the location in the file
// ("/accessors/3/bufferView", "line 3, column 7", "byte 12"), UsageError if options.scene or options.variant does not exist, MemoryError.
// finish() decodes the images on all cores; it throws FileError and MemoryError.
PendingScene beginLoadingGltf(const std::filesystem::path& file, const GltfOptions& options = {});

// Both steps.
Scene loadGltf(const std::filesystem::path& file, const GltfOptions& options = {});

}  // namespace quintet::scene
#endif
