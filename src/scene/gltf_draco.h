// KHR_draco_mesh_compression: one primitive's connectivity and attributes in a Draco stream.
#ifndef QUINTET_SCENE_GLTF_DRACO_H
#define QUINTET_SCENE_GLTF_DRACO_H

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scene/gltf_document.h"

namespace quintet::scene {

class DracoMesh {
 public:
  // Decodes the whole stream; `place` is the extension object's. Throws FileError.
  DracoMesh(const Document&, const tinygltf::Primitive&, const tinygltf::Value& extension, std::string place);
  ~DracoMesh();

  bool has(const std::string& attribute) const;  // the stream holds it
  // Three per triangle.
  std::vector<std::uint32_t> indices() const;
  // vec2, vec3, vec4 (missing components of a vec4 are 1: colours) or u16vec4; `place` is the attribute's.
  template <class Vec>
  std::vector<Vec> read(const std::string& attribute, const std::string& place) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace quintet::scene
#endif
