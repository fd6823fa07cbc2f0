// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/gltf.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <utility>

#include "base/memory_budget.h"
#include "base/stopwatch.h"
#include "scene/animation/material_states.h"
#include "scene/animation/pose.h"
#include "scene/geometry/texture_coordinates.h"
#include "scene/gltf/accessor.h"
#include "scene/gltf/animations.h"
#include "scene/gltf/extensions.h"
#include "scene/gltf/image_based_light.h"
#include "scene/gltf/instances.h"
#include "scene/gltf/inventory.h"
#include "scene/gltf/material.h"
#include "scene/gltf/nodes.h"
#include "scene/gltf/texture.h"
#include "scene/gltf/variants.h"
#include "scene/model/limits.h"

namespace quintet::scene {
namespace {

// The part of a file that remains in memory until its images are decoded.
struct OpenFile {
  OpenFile(const std::filesystem::path& file, const LoadOptions& options, std::shared_ptr<MemoryBudget> budget)
      : document(readDocument(file, options.allowExternal, std::move(budget))) {
    resolveBufferViews(document);
    checkAccessors(document);
  }
  Document document;
  std::vector<ImageUse> imageUses;
};

void readHeader(const Document& document, Scene& scene) {
  scene.name = document.file.filename().string();
  scene.report.generator = document.model.asset.generator;
  scene.report.copyright = document.model.asset.copyright;
  scene.report.files = document.files;
  reportExtensions(document.model.extensionsUsed, scene.report);
  scene.report.variants = variantNames(document);
  scene.report.metadata = document.metadata;
}

// Adds the instances and the light of each visible node, and the camera of each node.
void readSceneNodes(const Document& document, const NodeTree& tree, const PlayedAnimation& animation,
                    InstanceBuilder& instances, Scene& scene) {
  for (const int index : tree.sceneNodes) {
    const auto i = static_cast<std::size_t>(index);
    const tinygltf::Node& node = document.model.nodes[i];
    const std::size_t firstCamera = scene.cameras.size(), firstLight = scene.lights.size();
    const bool visible = tree.visible[i] || animation.togglesNode(index);  // at any time
    if (visible) instances.addNode(index);
    if (!isWithinLimits(vec3(tree.worldFromNode[i][3]))) {
      if (node.camera != kNone || node.extensions.contains(kPunctualLights))
        scene.report.ignored.push_back(fmt::format(
            "/nodes/{}: its camera or light is more than {:g} m from the origin; ignored", index, kMaxCoordinate));
      continue;
    }
    if (node.camera != kNone) scene.cameras.push_back(readCamera(document, node.camera, node, tree.worldFromNode[i]));
    const tinygltf::Value* light = findExtension(node.extensions, kPunctualLights);
    if (light && visible) readLight(document, indexOf(*light, "light"), node, tree.worldFromNode[i], scene);
    for (std::size_t k = firstCamera; k < scene.cameras.size(); ++k) {
      if (animation.movesNode(index)) scene.cameras[k].node = index;
      scene.cameras[k].values = animation.cameraValues(node.camera);
    }
    for (std::size_t k = firstLight; k < scene.lights.size(); ++k) {
      if (animation.movesNode(index)) scene.lights[k].node = index;
      if (animation.togglesNode(index)) scene.lights[k].visibleNode = index;
      scene.lights[k].values = animation.lightValues(indexOf(*light, "light"));
    }
  }
}

// Copies the materials of primitives without the texture coordinates that their textures need.
void removeTexturesWithoutUvs(const TextureTable& textures, Scene& scene) {
  const std::vector<MaterialCopy> copies = copyMaterialsWithoutUvs(scene);
  for (const MaterialCopy& copy : copies) {
    // Without its texture, the roughness of a specular-glossiness material is that of the factor.
    const TextureUse& before = scene.materials[static_cast<std::size_t>(copy.from)].metallicRoughnessTexture;
    Material& material = scene.materials[static_cast<std::size_t>(copy.copy)];
    if (!before.used() || material.metallicRoughnessTexture.used()) continue;
    const int image = textures.textures()[static_cast<std::size_t>(before.texture)].image;
    if (const auto& glossiness = textures.imageUses()[static_cast<std::size_t>(image)].glossiness)
      material.roughness = 1.0f - *glossiness;
  }
  // The file was just read, so that no other scene shares its animation.
  if (scene.nodeAnimation) animateCopies(*std::const_pointer_cast<NodeAnimation>(scene.nodeAnimation), copies);
}

// Frame 0.
void startAnimation(Scene& scene) {
  const NodeAnimation& animation = *scene.nodeAnimation;
  if (!animation.materials.empty()) scene.materialStates.resize(scene.materials.size());
  for (const AnimatedMaterial& animated : animation.materials) {
    const auto m = static_cast<std::size_t>(animated.material);
    scene.materialStates[m] = materialStates(scene.materials[m], animated.values, animation);
  }
  applyPose(scene, poseAt(&animation, 0.0), Hidden::keep);
}

// Materials use their factors instead of the textures whose images could not be read.
void removeImages(const OpenFile& file, const std::vector<ImageFailure>& failures, Scene& scene) {
  std::map<int, std::string> problems;  // of images of the file, each listed once
  for (const ImageFailure& failure : failures) {
    problems.emplace(file.imageUses[failure.use].image, failure.problem);
    removeTextures(scene, static_cast<int>(failure.use), file.imageUses[failure.use].glossiness);
  }
  std::vector<MissingImage> missing;
  for (const auto& [image, problem] : problems) missing.push_back({image, problem});
  reportMissingImages(file.document, missing, scene.report);
}

// The second step. `replace`: use the factors of materials instead of images that cannot be read. `strict`: fail for images
// with values that are repaired.
void finishImages(const OpenFile& file, bool replace, bool strict, Scene& scene) {
  const Stopwatch decoding;
  const std::vector<ImageFailure> failures =
      decodeImages(file.document, file.imageUses, scene.images, scene.report.repaired, *file.document.budget);
  if (!failures.empty()) {
    const ImageFailure& first = failures.front();
    if (!replace) file.document.fail(first.location, first.problem, first.remedy);
    removeImages(file, failures, scene);
  }
  makePrintable(scene.report);
  if (strict) requireExact(file.document.file, scene.report);
  scene.seconds.images = decoding.seconds();
}

PendingScene begin(const std::filesystem::path& path, const LoadOptions& options,
                   std::shared_ptr<MemoryBudget> budget) {
  Stopwatch watch;
  if (!budget) budget = std::make_shared<MemoryBudget>(path, options.maxMemory);
  const auto file = std::make_shared<OpenFile>(path, options, std::move(budget));
  if (!options.variant.empty()) selectVariant(file->document, options.variant);
  const Document& document = file->document;
  Scene scene;
  readHeader(document, scene);
  const NodeTree tree = readNodes(document, findScene(document, options.scene), scene.report);
  TextureTable textures(document, scene.report);
  scene.materials = readMaterials(document, textures, scene.report);
  scene.report.animations = summarizeAnimations(document, scene.materials, scene.report);
  PlayedAnimation animation;
  if (options.animation)
    animation = playAnimation(document, tree, scene.materials, *options.animation, options.framesPerSecond);
  scene.nodeAnimation = animation.data;
  if (!animation.data) scene.report.ignoredAnimations = scene.report.animations.size();
  InstanceBuilder instances(document, tree, animation, scene.report);
  readSceneNodes(document, tree, animation, instances, scene);
  scene.seconds.document = watch.lap();
  instances.finish(scene, *document.budget);
  removeTexturesWithoutUvs(textures, scene);
  if (scene.nodeAnimation) startAnimation(scene);
  scene.seconds.meshes = watch.lap();

  scene.textures = textures.textures();
  file->imageUses = textures.imageUses();
  const bool replace = options.missingTextures == MissingTextures::warn && !options.strict;
  ImageBasedLight light = readImageBasedLight(document, tree.scene, replace, scene.report);
  completeReport(document, tree, textures, animation, scene.materials, light, scene.report);
  scene.environment = std::move(light.environment);
  makePrintable(scene.report);
  if (options.strict) requireExact(path, scene.report);
  const bool described = describeImages(document, file->imageUses, scene.images);
  const auto decode = [file, replace, strict = options.strict](Scene& pending) {
    withMemoryErrors(file->document.file, [&] { finishImages(*file, replace, strict, pending); });
  };
  return {std::move(scene), described, decode};
}

}  // namespace

PendingScene beginLoadingGltf(const std::filesystem::path& file, const LoadOptions& options,
                              std::shared_ptr<MemoryBudget> budget) {
  return withMemoryErrors(file, [&] { return begin(file, options, std::move(budget)); });
}

Scene loadGltf(const std::filesystem::path& file, const LoadOptions& options) {
  return beginLoadingGltf(file, options).finish();
}

}  // namespace quintet::scene
