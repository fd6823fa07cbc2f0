// SPDX-License-Identifier: Apache-2.0
// A scene of any number of triangles for measurements of loading: a displaced sphere, split into meshes along its
// meridians, with normals and texture coordinates. It is written in pieces, so that the file is never in memory as a
// whole.
#ifndef QUINTET_DEMO_LARGE_SCENE_H
#define QUINTET_DEMO_LARGE_SCENE_H

#include <cstdint>
#include <filesystem>

namespace quintet::demo {

struct LargeSceneOptions {
  std::uint64_t triangles = 10'000'000;  // approximate; at least 8 per mesh
  std::uint32_t meshes = 1;
  std::uint32_t textures = 0;        // base color textures, distributed among the meshes
  std::uint32_t textureSize = 1024;  // pixels per side
  bool normalMaps = false;           // one per base color texture, so that the importer generates tangents
};

// Writes a binary glTF 2.0 file and returns the number of triangles. The same options give the same bytes. Throws
// FileError, UsageError above the limit of a GLB (4 GiB).
std::uint64_t writeLargeScene(const std::filesystem::path& file, const LargeSceneOptions& options);

}  // namespace quintet::demo
#endif
