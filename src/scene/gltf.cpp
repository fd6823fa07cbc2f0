#include "scene/gltf.h"

#include <fmt/format.h>

#include <new>

#include "base/error.h"
#include "base/stopwatch.h"
#include "scene/gltf_extensions.h"
#include "scene/gltf_instances.h"
#include "scene/gltf_material.h"
#include "scene/gltf_nodes.h"
#include "scene/gltf_placement.h"
#include "scene/memory_budget.h"
#include "scene/printable.h"

namespace quintet::scene {
namespace {

// The lines quote names from the file.
void makePrintable(Report& report) {
  for (auto* lines : {&report.extensionsUsed, &report.extensionsIgnored, &report.ignored, &report.repaired})
    for (std::string& line : *lines) line = printable(line);
  report.generator = printable(report.generator);
  report.copyright = printable(report.copyright);
}

Scene load(const std::filesystem::path& file, const LoadOptions& options) {
  Stopwatch watch;
  const Document document = readDocument(file);
  Scene scene;
  scene.name = file.filename().string();
  scene.report.generator = document.model.asset.generator;
  scene.report.copyright = document.model.asset.copyright;
  scene.report.files = document.files;
  reportExtensions(document, scene.report);
  if (document.animationCount > 0)
    scene.report.ignored.push_back(fmt::format("/animations: {}, the rest pose is shown", document.animationCount));

  const NodeTree tree = readNodes(document, options.scene, scene.report);
  TextureTable textures(document, scene.report);
  scene.materials = readMaterials(document, textures, scene.report);
  InstanceBuilder instances(document, tree, scene.report);
  for (const int index : tree.shown) {
    const auto i = static_cast<std::size_t>(index);
    const tinygltf::Node& node = document.model.nodes[i];
    instances.addNode(index);
    if (node.camera != kNone) scene.cameras.push_back(placeCamera(document, node.camera, node, tree.worldFromNode[i]));
    if (const tinygltf::Value* light = findExtension(node.extensions, kPunctualLights))
      placeLight(document, indexOf(*light, "light"), node, tree.worldFromNode[i], scene);
  }
  MemoryBudget budget(file);
  scene.seconds.document = watch.lap();
  instances.finish(scene, budget);
  scene.seconds.meshes = watch.lap();
  const bool early = textures.describe(scene) && options.described;
  if (early) options.described(scene);
  watch.lap();
  textures.decode(scene, budget);
  scene.seconds.images = watch.lap();
  if (!early && options.described) options.described(scene);
  makePrintable(scene.report);
  return scene;
}

}  // namespace

Scene loadGltf(const std::filesystem::path& file, const LoadOptions& options) {
  try {
    return load(file, options);
  } catch (const std::bad_alloc&) {
    throw MemoryError(file.string() + ": not enough memory for the scene");
  } catch (const std::length_error&) {
    throw MemoryError(file.string() + ": the scene is larger than any memory");
  }
}

}  // namespace quintet::scene
