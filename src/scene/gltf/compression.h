// SPDX-License-Identifier: Apache-2.0
// The compression extensions: KHR_meshopt_compression and its predecessor EXT_meshopt_compression (buffer views in
// meshoptimizer's vertex and index codecs), and KHR_draco_mesh_compression (triangles and attributes of one primitive in a
// Draco stream).
#ifndef QUINTET_SCENE_GLTF_COMPRESSION_H
#define QUINTET_SCENE_GLTF_COMPRESSION_H

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scene/gltf/document.h"

namespace quintet::scene {

// Decompressed bytes of `view`, which has the extension `name`. `location` is that of the extension object. Throws FileError.
FileBytes decodeMeshopt(const Document&, const tinygltf::BufferView& view, const std::string& name,
                        const std::string& location);

class DracoMesh {
 public:
  // Decodes the whole stream. `location` is that of the extension object. Throws FileError.
  DracoMesh(const Document&, const tinygltf::Primitive&, const tinygltf::Value& extension, std::string location);
  ~DracoMesh();

  // Whether the stream contains the attribute.
  bool has(const std::string& attribute) const;
  // Three indices per triangle.
  std::vector<std::uint32_t> indices() const;
  // Vec is vec2, vec3, vec4 (a color without alpha gets 1) or u16vec4. `location` is that of the attribute.
  template <class Vec>
  std::vector<Vec> read(const std::string& attribute, const std::string& location) const;

 private:
  struct State;  // hides the headers of Draco
  std::unique_ptr<State> state_;
};

}  // namespace quintet::scene
#endif
