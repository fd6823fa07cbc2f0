// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/gltf.h"

#include <fmt/format.h>

#include <memory>

#include "base/stopwatch.h"
#include "base/text.h"
#include "scene/gltf/accessor.h"
#include "scene/gltf/extensions.h"
#include "scene/gltf/instances.h"
#include "scene/gltf/material.h"
#include "scene/gltf/nodes.h"
#include "scene/gltf/texture.h"
#include "scene/gltf/variants.h"
#include "scene/memory_budget.h"

namespace quintet::scene {
namespace {

// The part of a file that remains in memory until its images are decoded.
struct OpenFile {
  explicit OpenFile(const std::filesystem::path& file) : document(readDocument(file)), budget(file) {
    resolveBufferViews(document);
    checkAccessors(document);
  }
  Document document;
  MemoryBudget budget;
  std::vector<ImageUse> imageUses;
};

// The report quotes names from the file.
void makePrintable(Report& report) {
  for (auto* lines : {&report.extensionsUsed, &report.extensionsIgnored, &report.ignored, &report.repaired})
    for (std::string& line : *lines) line = printable(line);
  report.generator = printable(report.generator);
  report.copyright = printable(report.copyright);
}

void readHeader(const Document& document, Scene& scene) {
  scene.name = document.file.filename().string();
  scene.report.generator = document.model.asset.generator;
  scene.report.copyright = document.model.asset.copyright;
  scene.report.files = document.files;
  reportExtensions(document.model.extensionsUsed, scene.report);
  scene.report.variants = variantNames(document);
  scene.report.ignoredAnimations = document.animationCount;
  if (document.animationCount > 0)
    scene.report.ignored.push_back(
        fmt::format("/animations: {} not played; the rest pose is used", document.animationCount));
}

// Adds the instances, the camera and the light of each node.
void readSceneNodes(const Document& document, const NodeTree& tree, InstanceBuilder& instances, Scene& scene) {
  for (const int index : tree.sceneNodes) {
    const auto i = static_cast<std::size_t>(index);
    const tinygltf::Node& node = document.model.nodes[i];
    instances.addNode(index);
    if (node.camera != kNone) scene.cameras.push_back(readCamera(document, node.camera, node, tree.worldFromNode[i]));
    if (const tinygltf::Value* light = findExtension(node.extensions, kPunctualLights))
      readLight(document, indexOf(*light, "light"), node, tree.worldFromNode[i], scene);
  }
}

PendingScene begin(const std::filesystem::path& path, const GltfOptions& options) {
  Stopwatch watch;
  const auto file = std::make_shared<OpenFile>(path);
  if (!options.variant.empty()) selectVariant(file->document, options.variant);
  const Document& document = file->document;
  Scene scene;
  readHeader(document, scene);
  const NodeTree tree = readNodes(document, options.scene, scene.report);
  TextureTable textures(document, scene.report);
  scene.materials = readMaterials(document, textures, scene.report);
  InstanceBuilder instances(document, tree, scene.report);
  readSceneNodes(document, tree, instances, scene);
  scene.seconds.document = watch.lap();
  instances.finish(scene, file->budget);
  scene.seconds.meshes = watch.lap();

  scene.textures = textures.textures();
  file->imageUses = textures.imageUses();
  makePrintable(scene.report);
  const bool described = describeImages(document, file->imageUses, scene.images);
  const auto decode = [file](Scene& pending) {
    withMemoryErrors(file->document.file, [&] {
      const Stopwatch decoding;
      decodeImages(file->document, file->imageUses, pending.images, file->budget);
      pending.seconds.images = decoding.seconds();
    });
  };
  return {std::move(scene), described, decode};
}

}  // namespace

PendingScene beginLoadingGltf(const std::filesystem::path& file, const GltfOptions& options) {
  return withMemoryErrors(file, [&] { return begin(file, options); });
}

Scene loadGltf(const std::filesystem::path& file, const GltfOptions& options) {
  return beginLoadingGltf(file, options).finish();
}

}  // namespace quintet::scene
