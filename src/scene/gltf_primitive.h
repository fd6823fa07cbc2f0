// Reads one primitive's attributes, from accessors or from its Draco stream.
#ifndef QUINTET_SCENE_GLTF_PRIMITIVE_H
#define QUINTET_SCENE_GLTF_PRIMITIVE_H

#include <memory>
#include <optional>
#include <string>

#include "scene/deform.h"
#include "scene/gltf_document.h"

namespace quintet::scene {

class DracoMesh;

class PrimitiveReader {
 public:
  PrimitiveReader(const Document&, int mesh, int primitive);
  ~PrimitiveReader();

  const tinygltf::Primitive& primitive() const { return primitive_; }
  const std::string& place() const { return place_; }  // "/meshes/0/primitives/2"
  bool has(const std::string& attribute) const { return primitive_.attributes.contains(attribute); }

  // Positions, normals, tangents, texture coordinates, colours; all counts equal.
  Geometry readAttributes() const;
  // Indexed or not; every index below vertexCount.
  std::vector<uvec3> readTriangles(std::size_t vertexCount) const;
  // JOINTS_0/WEIGHTS_0 and JOINTS_1/WEIGHTS_1; every joint below jointCount. Empty: the primitive is not skinned.
  std::vector<SkinSet> readSkinSets(std::size_t vertexCount, std::size_t jointCount) const;
  MorphTarget readMorphTarget(std::size_t index, const Geometry& base) const;

 private:
  std::string attributePlace(const std::string& name) const { return place_ + "/attributes/" + name; }
  void checkCount(std::size_t count, std::size_t vertexCount, const std::string& place) const;
  std::vector<std::uint32_t> readIndexList() const;

  const Document& document_;
  const tinygltf::Primitive& primitive_;
  std::string place_;
  std::unique_ptr<DracoMesh> draco_;
};

}  // namespace quintet::scene
#endif
