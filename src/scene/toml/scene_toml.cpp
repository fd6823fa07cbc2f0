// SPDX-License-Identifier: Apache-2.0
#include "scene/toml/scene_toml.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/memory_budget.h"
#include "scene/animation/material_states.h"
#include "scene/animation/pose.h"
#include "scene/geometry/texture_coordinates.h"
#include "scene/model/validate.h"
#include "scene/toml/context.h"

namespace quintet::scene {
namespace {

// Bytes that parsing requires for each byte of text: 90 for a list of numbers of one digit.
constexpr std::size_t kTomlMemory = 96;

void rejectGltfOptions(const std::filesystem::path& file, const LoadOptions& options) {
  const auto reject = [&](const std::string& value, const char* key, const char* what) {
    if (value.empty()) return;
    throw UsageError(
        fmt::format("{}: no {} '{}': only glTF files have {}s; a scene file selects them by the key '{}' of [[file]]",
                    file.string(), key, value, what, key));
  };
  reject(options.variant, "variant", "material variant");
  reject(options.scene, "scene", "scene");
}

// Of the glTF files and of keyframes. What has keyframes becomes that of frame 0.
void finishAnimation(SceneTomlContext& context) {
  Scene& scene = context.scene;
  if (!scene.materialStates.empty()) scene.materialStates.resize(scene.materials.size());
  if (context.animation.nodes.empty() && context.animation.values.empty()) return;
  scene.nodeAnimation = std::make_shared<NodeAnimation>(std::move(context.animation));
  if (scene.report.keyframes.empty()) return;
  const Pose pose = poseAt(scene.nodeAnimation.get(), 0.0);
  for (Light& light : scene.lights)
    if (!light.values.empty() && light.node == kNone && light.visibleNode == kNone) light = lightAt(light, pose);
  for (Camera& camera : scene.cameras)
    if (!camera.values.empty() && camera.node == kNone) camera = cameraAt(camera, pose);
  moveEnvironment(scene.environment, pose);
  if (!scene.nodeAnimation->materials.empty()) scene.materialStates.resize(scene.materials.size());
  for (const AnimatedMaterial& animated : scene.nodeAnimation->materials) {
    const auto m = static_cast<std::size_t>(animated.material);
    if (!scene.materialStates[m].empty()) continue;  // of a glTF file
    scene.materialStates[m] = materialStates(scene.materials[m], animated.values, *scene.nodeAnimation);
    scene.materials[m] = materialAt(scene.materials[m], animated.values, pose);
  }
}

// Textures are ignored where a mesh does not have the texture coordinates that they use.
void removeTexturesWithoutUvs(SceneTomlContext& context) {
  Scene& scene = context.scene;
  for (const Mesh& mesh : scene.meshes)
    for (const Geometry& geometry : mesh.geometries) {
      if (geometry.material == kNone) continue;
      const Material& material = scene.materials[static_cast<std::size_t>(geometry.material)];
      const unsigned missing = missingUvSets(geometry, material);
      for (int set = 0; set < kMaxUvSets; ++set)
        if (missing >> set & 1u)
          scene.report.repaired.push_back(
              fmt::format("mesh '{}': the textures of material '{}' that use set {} are ignored, because the mesh does "
                          "not have these texture coordinates",
                          mesh.name, material.name, set));
    }
  animateCopies(context.animation, copyMaterialsWithoutUvs(scene));
}

Scene read(std::string_view text, const std::filesystem::path& file, const LoadOptions& options) {
  rejectGltfOptions(file, options);
  SceneTomlContext context(file, options);
  context.budget.take(kTomlMemory * text.size());
  const TomlValue document = parseToml(text, file);
  context.scene.name = file.filename().string();
  context.scene.report.files.push_back(file);
  TomlReader root(document, "the scene", context.file);
  readFiles(context, root);
  readMaterials(context, root);
  readMeshes(context, root);
  readPrimitives(context, root);
  readInstances(context, root);
  readLights(context, root);
  readCameras(context, root);
  readEnvironment(context, root);
  root.rejectUnknownKeys();
  removeTexturesWithoutUvs(context);
  finishAnimation(context);
  makePrintable(context.scene.report);
  if (options.strict) requireExact(file, context.scene.report);
  // The readers have checked everything, with line numbers. This finds errors that they miss.
  try {
    validate(context.scene);
  } catch (const Error& error) {
    throw FileError(file, error.what());
  }
  return std::move(context.scene);
}

}  // namespace

Scene loadSceneToml(const std::filesystem::path& file, const LoadOptions& options) {
  MemoryBudget budget(file, options.maxMemory);
  return parseSceneToml(readTextFile(file, budget), file, options);
}

Scene parseSceneToml(std::string_view text, const std::filesystem::path& file, const LoadOptions& options) {
  return withMemoryErrors(file, [&] { return read(text, file, options); });
}

}  // namespace quintet::scene
