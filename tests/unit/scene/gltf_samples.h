// SPDX-License-Identifier: Apache-2.0
// glTF files with many features, for tests that change them.
#ifndef QUINTET_TESTS_GLTF_SAMPLES_H
#define QUINTET_TESTS_GLTF_SAMPLES_H

#include <cstddef>
#include <string>
#include <vector>

#include "scene/gltf_builder.h"

namespace quintet::test {

// A small scene with a skin, morph targets, textures, indices, sparse data, a light, a camera and instances.
GltfBuilder sceneWithEverything();

// Two triangles around the origin with texture coordinates, as a Draco stream (KHR_draco_mesh_compression).
struct DracoBuilder : GltfBuilder {
  DracoBuilder();
  Json& draco() { return primitive()["extensions"]["KHR_draco_mesh_compression"]; }
};

// A strip of 20 vertices, compressed as attributes in buffer view 0, and its triangles in buffer view 1. `extension` is
// EXT_meshopt_compression or KHR_meshopt_compression.
struct MeshoptBuilder : GltfBuilder {
  explicit MeshoptBuilder(std::string extension = "EXT_meshopt_compression");
  void addCompressed(const std::vector<unsigned char>& data, std::size_t count, std::size_t stride, const char* mode);
  Json& meshopt(std::size_t view) { return root["bufferViews"][view]["extensions"][extension]; }
  std::string extension;
};

// The strip with KHR_meshopt_compression: positions in version 1 of the vertex codec in buffer view 2, and colors with the
// filter COLOR in buffer view 3: (150, 70, 110, 255).
MeshoptBuilder stripInVersion1();

}  // namespace quintet::test
#endif
