// Loads glTF 2.0 files (.gltf and .glb, told apart by content) into a scene. docs/gltf.md says what
// becomes of each part of the file.
#ifndef QUINTET_SCENE_GLTF_H
#define QUINTET_SCENE_GLTF_H

#include <filesystem>
#include <functional>

#include "scene/scene.h"

namespace quintet::scene {

// Called once during the loading, when all is known but what is in the pictures: their sizes and channels are, their data
// is empty. (Where pictures are files of their own, that is at the end.)
using Described = std::function<void(const Scene&)>;

struct LoadOptions {
  int scene =
      kNone;  // index of the file's scene to load; kNone: its default scene, else its first, else all root nodes
  Described described;
};

// Throws FileError with the place in the file ("/accessors/3/bufferView", "line 3, column 7", "byte 12"),
// UsageError if options.scene does not exist, MemoryError. Uses all cores for images and meshes.
Scene loadGltf(const std::filesystem::path& file, const LoadOptions& options = {});

}  // namespace quintet::scene
#endif
