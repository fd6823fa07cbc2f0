#include "scene/gltf_mesh.h"

#include <fmt/format.h>

#include <algorithm>

#include "scene/deform.h"
#include "scene/gltf_primitive.h"
#include "scene/repair.h"
#include "scene/tangents.h"

namespace quintet::scene {
namespace {

// Attributes that are in the file but not used.
void reportAttributes(const tinygltf::Primitive& primitive, const std::string& place, GeometryResult& result) {
  for (const auto& [name, accessor] : primitive.attributes) {
    const bool used = name == "POSITION" || name == "NORMAL" || name == "TANGENT" || name == "TEXCOORD_0" ||
                      name == "TEXCOORD_1" || name == "COLOR_0" || name == "JOINTS_0" || name == "JOINTS_1" ||
                      name == "WEIGHTS_0" || name == "WEIGHTS_1";
    if (!used) result.ignored.push_back(fmt::format("{}/attributes/{}: the attribute is not used", place, name));
  }
}

void applyMorphTargets(Geometry& geometry, const PrimitiveReader& reader, std::span<const double> weights) {
  for (std::size_t i = 0; i < reader.primitive().targets.size(); ++i) {
    const MorphTarget target = reader.readMorphTarget(i, geometry);  // checks the ones without weight too
    const float weight = i < weights.size() ? static_cast<float>(weights[i]) : 0.0f;
    if (weight != 0.0f) applyMorphTarget(geometry, target, weight);
  }
}

void deform(Geometry& geometry, const PrimitiveReader& reader, const tinygltf::Mesh& mesh,
            const Deformation& deformation) {
  applyMorphTargets(geometry, reader, deformation.morphWeights.empty() ? mesh.weights : deformation.morphWeights);
  if (!deformation.jointMatrices.empty()) {
    const auto sets = reader.readSkinSets(geometry.positions.size(), deformation.jointMatrices.size());
    if (!sets.empty()) return applySkin(geometry, sets, deformation.jointMatrices);
  }
  if (deformation.bake) applyTransform(geometry, *deformation.bake);
}

void repair(Geometry& geometry, const std::string& place, GeometryResult& result) {
  const auto note = [&](std::size_t count, const char* what) {
    if (count > 0) result.repaired.push_back(fmt::format("{}: {} {}", place, count, what));
  };
  note(dropNonFiniteTriangles(geometry), "triangles with non-finite vertices dropped");
  note(repairNormals(geometry), "normals without a direction replaced");
  note(repairUvsAndColors(geometry), "non-finite texture coordinates or colours replaced");
  if (geometry.normals.empty()) geometry.tangents.clear();  // glTF 2.0 section 3.7.2.1: they are to be ignored
  note(repairTangents(geometry), "tangents without a direction replaced");
}

const char* modeName(int mode) {
  constexpr const char* kNames[] = {"POINTS", "LINES", "LINE_LOOP", "LINE_STRIP"};
  return kNames[mode];
}

}  // namespace

GeometryResult readGeometry(const Document& document, const std::vector<Material>& materials, int meshIndex,
                            int primitiveIndex, const Deformation& deformation) {
  const tinygltf::Mesh& mesh = document.model.meshes[static_cast<std::size_t>(meshIndex)];
  const PrimitiveReader reader(document, meshIndex, primitiveIndex);
  const std::string& place = reader.place();
  GeometryResult result;
  if (const int mode = reader.primitive().mode; mode < TINYGLTF_MODE_TRIANGLES) {
    result.ignored.push_back(fmt::format("{}: mode {} has no surface", place, modeName(mode)));
    return result;
  }
  if (!reader.has("POSITION")) {
    result.ignored.push_back(place + ": no POSITION, nothing to show");
    return result;
  }
  reportAttributes(reader.primitive(), place, result);

  Geometry geometry = reader.readAttributes();
  geometry.triangles = reader.readTriangles(geometry.positions.size());
  geometry.material = reader.primitive().material;
  deform(geometry, reader, mesh, deformation);
  repair(geometry, place, result);
  if (geometry.triangles.empty()) {
    result.ignored.push_back(place + ": no triangle, nothing to show");
    return result;
  }
  dropUnusedVertices(geometry);
  if (geometry.material != kNone) addTangents(geometry, materials[static_cast<std::size_t>(geometry.material)]);
  result.geometry = std::move(geometry);
  return result;
}

void checkMorphTargets(const Document& document, int meshIndex) {
  const tinygltf::Mesh& mesh = document.model.meshes[static_cast<std::size_t>(meshIndex)];
  const std::string place = fmt::format("/meshes/{}", meshIndex);
  if (mesh.primitives.empty()) document.fail(place + "/primitives", "must not be empty");
  const std::size_t count = mesh.primitives[0].targets.size();
  for (std::size_t i = 1; i < mesh.primitives.size(); ++i)
    if (mesh.primitives[i].targets.size() != count)
      document.fail(fmt::format("{}/primitives/{}/targets", place, i),
                    fmt::format("{} morph targets, but primitive 0 has {}", mesh.primitives[i].targets.size(), count));
  if (!mesh.weights.empty() && mesh.weights.size() != count)
    document.fail(place + "/weights", fmt::format("{} weights for {} morph targets", mesh.weights.size(), count));
}

}  // namespace quintet::scene
