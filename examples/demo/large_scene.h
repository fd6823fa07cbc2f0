// A scene of any number of triangles, to measure loading: a displaced sphere, cut into meshes along its meridians,
// with normals and texture coordinates. Written piece by piece: the file is never in memory as a whole.
#ifndef QUINTET_DEMO_LARGE_SCENE_H
#define QUINTET_DEMO_LARGE_SCENE_H

#include <cstdint>
#include <filesystem>

namespace quintet::demo {

struct LargeSceneOptions {
  std::uint64_t triangles = 10'000'000;  // about; at least 8 for each mesh are made
  std::uint32_t meshes = 1;
  std::uint32_t textures = 0;        // base colours, shared out among the meshes
  std::uint32_t textureSize = 1024;  // pixels a side
  bool normalMaps = false;           // one beside each base colour: the importer has to make tangents
};

// Writes a binary glTF 2.0 file; the same options give the same bytes. Returns the number of triangles.
// Throws FileError; UsageError for what a GLB cannot hold (4 GiB).
std::uint64_t writeLargeScene(const std::filesystem::path& file, const LargeSceneOptions& options);

}  // namespace quintet::demo
#endif
