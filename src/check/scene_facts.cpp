// SPDX-License-Identifier: Apache-2.0
#include "check/scene_facts.h"

#include <algorithm>

#include "scene/model/names.h"
#include "scene/model/surface_class.h"

namespace quintet::check {
namespace {

program::GeometryKind kindOf(scene::PrimitiveSetKind kind) {
  switch (kind) {
    case scene::PrimitiveSetKind::solids: return program::GeometryKind::solids;
    case scene::PrimitiveSetKind::csg: return program::GeometryKind::csg;
    case scene::PrimitiveSetKind::custom: break;
  }
  return program::GeometryKind::custom;
}

std::string materialName(const scene::Scene& scene, int material) {
  return material == scene::kNone ? std::string() : scene.materials[static_cast<std::size_t>(material)].name;
}

int materialOf(const scene::PrimitiveSet& set) {
  return set.kind == scene::PrimitiveSetKind::custom || set.primitives.empty() ? set.material
                                                                               : set.primitives.front().material;
}

}  // namespace

program::SceneFacts sceneFacts(const scene::Scene& scene) {
  program::SceneFacts facts;
  facts.name = scene::nameForMessages(scene);
  std::vector<std::uint32_t> first;
  for (const scene::Mesh& mesh : scene.meshes) {
    first.push_back(static_cast<std::uint32_t>(facts.geometries.size()));
    for (const scene::Geometry& g : mesh.geometries)
      facts.geometries.push_back({program::GeometryKind::triangles, scene::needsAlphaTest(scene, g), mesh.name,
                                  materialName(scene, g.material), scene::isPane(scene, g),
                                  scene::tintsShadows(scene, g)});
    for (const scene::PrimitiveSet& set : mesh.primitiveSets)
      facts.geometries.push_back({kindOf(set.kind), scene::needsAlphaTest(scene, set), set.name,
                                  materialName(scene, materialOf(set)), scene::isPane(scene, set),
                                  scene::tintsShadows(scene, set)});
  }
  for (const scene::Instance& instance : scene.instances) {
    const auto mesh = static_cast<std::size_t>(instance.mesh);
    facts.instances.push_back(
        {instance.name, first[mesh], static_cast<std::uint32_t>(scene.meshes[mesh].geometryCount()), instance.mask,
         (instance.flags & scene::kInstanceForceOpaque) != 0, (instance.flags & scene::kInstanceForceNoOpaque) != 0,
         instance.customIndex, instance.worldFromObject != mat4(1.0f) || instance.animated()});
  }
  return facts;
}

}  // namespace quintet::check
