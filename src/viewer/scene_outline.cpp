// SPDX-License-Identifier: Apache-2.0
#include "viewer/scene_outline.h"

#include <algorithm>

#include <fmt/format.h>

#include "job/interactive/light_properties.h"
#include "scene/model/mesh_bounds.h"

namespace quintet::viewer {
namespace {

InstanceOutline outlineOf(const scene::Scene& scene, std::size_t index, const std::string& name,
                          const std::vector<Bounds3>& meshBounds) {
  const scene::Instance& instance = scene.instances[index];
  const scene::Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
  InstanceOutline outline;
  outline.name = name;
  outline.mesh = mesh.name;
  outline.bounds = meshBounds[static_cast<std::size_t>(instance.mesh)];
  outline.animated = instance.animated();
  outline.worldFromObject = instance.worldFromObject;
  const auto addMaterial = [&](int material) {
    if (material < 0) return;
    const auto added = static_cast<std::size_t>(material);
    if (std::ranges::find(outline.materials, added) == outline.materials.end()) outline.materials.push_back(added);
  };
  for (const scene::Geometry& geometry : mesh.geometries) {
    outline.triangles += geometry.triangles.size();
    addMaterial(geometry.material);
  }
  for (const scene::PrimitiveSet& set : mesh.primitiveSets) {
    outline.boxes += scene::boxCount(set);
    addMaterial(set.material);
    for (const scene::Primitive& primitive : set.primitives) addMaterial(primitive.material);
  }
  return outline;
}

}  // namespace

SceneOutline outlineOf(const job::interactive::Session& session) {
  const scene::Scene& scene = session.scene();
  SceneOutline outline;
  outline.name = scene.name;
  std::vector<Bounds3> meshBounds;
  for (const scene::Mesh& mesh : scene.meshes) meshBounds.push_back(scene::meshBounds(mesh, mat4(1.0f)));
  for (std::size_t i = 0; i < scene.instances.size(); ++i)
    outline.instances.push_back(outlineOf(scene, i, session.instanceNames()[i], meshBounds));
  outline.materialNames = session.materialNames();
  outline.materials = scene.materials;
  outline.lightNames = session.lightNames();
  outline.lights = scene.lights;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    const std::string& name = scene.cameras[i].name;
    outline.cameras.push_back(name.empty() ? fmt::format("Camera {}", i) : name);
  }
  outline.variants = scene.report.variants;
  for (const scene::AnimationSummary& animation : scene.report.animations)
    outline.animations.push_back(animation.name.empty() ? std::to_string(outline.animations.size()) : animation.name);
  outline.triangles = scene::countTriangles(scene);
  outline.lastFrame = session.lastFrame();
  const Bounds3 bounds = session.bounds("");
  const float diagonal = bounds.empty() ? 0.0f : glm::length(bounds.extent());
  outline.size = diagonal > 0.0f ? diagonal : 1.0f;
  return outline;
}

const scene::Material& materialOf(const SceneOutline& scene, const job::interactive::SessionState& state,
                                  std::size_t index) {
  const auto edited = state.materials.find(index);
  return edited != state.materials.end() ? *edited->second : scene.materials[index];
}

job::interactive::LightState lightOf(const SceneOutline& scene, const job::interactive::SessionState& state,
                                     std::size_t index) {
  const auto edited = state.lights.find(index);
  return edited != state.lights.end() ? *edited->second
                                      : job::interactive::LightState{scene.lights[index], true,
                                                                     job::interactive::lightColor(scene.lights[index])};
}

mat4 transformOf(const SceneOutline& scene, const job::interactive::SessionState& state, std::size_t index) {
  const auto edited = state.transforms.find(index);
  return edited != state.transforms.end() ? edited->second : scene.instances[index].worldFromObject;
}

}  // namespace quintet::viewer
