// SPDX-License-Identifier: Apache-2.0
// [[file]]: makes the meshes, materials, lights and cameras of a glTF file available under its name.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "scene/gltf/gltf.h"
#include "scene/load.h"
#include "scene/model/material_textures.h"
#include "scene/toml/context.h"

namespace quintet::scene {
namespace {

std::string nameOrIndex(const std::string& name, const char* kind, std::size_t index) {
  return name.empty() ? fmt::format("{}{}", kind, index) : name;
}

void shift(int& index, std::size_t by) {
  if (index != kNone) index += static_cast<int>(by);
}

void shiftTextures(Material& material, std::size_t by) {
  for (const MaterialTexture& texture : kMaterialTextures) shift((material.*texture.use).texture, by);
}

template <class T>
void append(std::vector<T>& to, std::vector<T>&& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

// Moves images, textures, materials and meshes into the scene and adjusts their indices.
void appendResources(Scene& scene, Scene& part) {
  for (Texture& texture : part.textures) shift(texture.image, scene.images.size());
  for (Material& material : part.materials) shiftTextures(material, scene.textures.size());
  for (Mesh& mesh : part.meshes)
    for (Geometry& geometry : mesh.geometries) shift(geometry.material, scene.materials.size());
  if (!part.materialStates.empty() || !scene.materialStates.empty()) {
    scene.materialStates.resize(scene.materials.size());
    part.materialStates.resize(part.materials.size());
    for (std::vector<Material>& states : part.materialStates)
      for (Material& state : states) shiftTextures(state, scene.textures.size());
    append(scene.materialStates, std::move(part.materialStates));
  }
  append(scene.images, std::move(part.images));
  append(scene.textures, std::move(part.textures));
  append(scene.materials, std::move(part.materials));
  append(scene.meshes, std::move(part.meshes));
}

// ---- Animations ----

void shiftValues(std::vector<AnimatedValue>& values, std::size_t by) {
  for (AnimatedValue& value : values) value.value += by;
}

// Appends the nodes, skins and samplers of a file, and adjusts the indices of what they animate. `firstMaterial`: index in
// the scene of the first material of the file.
void appendAnimation(NodeAnimation& all, Scene& part, std::size_t firstMaterial) {
  if (!part.nodeAnimation) return;
  NodeAnimation from = *part.nodeAnimation;
  const std::size_t nodes = all.nodes.size(), skins = all.skins.size(), samplers = all.animation.samplers.size();
  const std::size_t values = all.values.size();
  for (AnimationNode& node : from.nodes) shift(node.parent, nodes);
  for (int& node : from.order) shift(node, nodes);
  for (Skin& skin : from.skins)
    for (int& joint : skin.joints) shift(joint, nodes);
  for (AnimationChannel& channel : from.animation.channels) {
    shift(channel.node, nodes);
    channel.sampler += samplers;
  }
  for (std::size_t& sampler : from.values) sampler += samplers;
  for (AnimatedMaterial& material : from.materials) {
    shift(material.material, firstMaterial);
    shiftValues(material.values, values);
  }
  append(all.nodes, std::move(from.nodes));
  append(all.order, std::move(from.order));
  append(all.skins, std::move(from.skins));
  append(all.animation.samplers, std::move(from.animation.samplers));
  append(all.animation.channels, std::move(from.animation.channels));
  append(all.values, std::move(from.values));
  append(all.materials, std::move(from.materials));

  for (Mesh& mesh : part.meshes) {
    if (!mesh.deformation) continue;
    // The file was just loaded, so that no other scene shares its deformations.
    const auto deformation = std::const_pointer_cast<MeshDeformation>(mesh.deformation);
    shift(deformation->node, nodes);
    shift(deformation->skin, skins);
  }
  for (Instance& instance : part.instances) shift(instance.node, nodes), shift(instance.visibleNode, nodes);
  for (Camera& camera : part.cameras) shift(camera.node, nodes), shiftValues(camera.values, values);
  for (Light& light : part.lights) {
    shift(light.node, nodes);
    shift(light.visibleNode, nodes);
    shiftValues(light.values, values);
  }
}

void appendReport(Report& report, const Report& part, const std::string& name) {
  const auto addNew = [](std::vector<std::string>& to, const std::string& value) {
    if (std::ranges::find(to, value) == to.end()) to.push_back(value);
  };
  for (const std::string& extension : part.extensionsUsed) addNew(report.extensionsUsed, extension);
  for (const std::string& extension : part.extensionsIgnored) addNew(report.extensionsIgnored, extension);
  for (Feature feature : part.features) {
    feature.location = name + ": " + feature.location;
    report.features.push_back(std::move(feature));
  }
  for (const std::string& line : part.ignored) report.ignored.push_back(name + ": " + line);
  for (const MetadataEntry& entry : part.metadata)
    report.metadata.push_back({name + ": " + entry.object, entry.name, entry.value});
  if (part.ignoredAnimations > 0) {
    report.ignoredAnimations += part.ignoredAnimations;
    report.ignored.push_back(
        fmt::format("{}: /animations: {} not played; the rest pose is used", name, part.ignoredAnimations));
  }
  for (const std::string& variant : part.variants) report.variants.push_back(name + "/" + variant);
  for (const std::string& line : part.repaired) report.repaired.push_back(name + ": " + line);
  if (!part.copyright.empty()) report.copyright += (report.copyright.empty() ? "" : "; ") + part.copyright;
}

// Adds the names "file/material" and "file/mesh". A part without a name in the file is called by its kind and index.
void addNames(SceneTomlContext& context, const TomlValue& at, const std::string& name, const Scene& part,
              std::size_t firstMaterial, std::size_t firstMesh) {
  for (std::size_t i = 0; i < part.materials.size(); ++i) {
    const std::string key = name + "/" + nameOrIndex(part.materials[i].name, "material", i);
    context.materials.emplace(key, static_cast<int>(firstMaterial + i));
  }
  for (std::size_t i = 0; i < part.meshes.size(); ++i) {
    const std::string key = name + "/" + nameOrIndex(part.meshes[i].name, "mesh", i);
    if (context.targets.contains(key)) continue;  // the first of several has the name
    InstanceTarget target;
    target.placedByDefault = false;
    Instance& instance = target.instances.emplace_back();
    instance.name = part.meshes[i].name;
    instance.mesh = static_cast<int>(firstMesh + i);
    context.addTarget(at, key, std::move(target));
  }
}

// `at`: what the user named, for errors about a variant or a scene that the file does not have.
Scene loadPart(SceneTomlContext& context, TomlReader& reader, const std::filesystem::path& path,
               const LoadOptions& options, const TomlValue& at) {
  try {
    return beginLoadingGltf(path, options, context.sharedBudget).finish();
  } catch (const UsageError& error) {
    reader.fail(at, error.what());
  }
}

void readFile(SceneTomlContext& context, const TomlValue& table) {
  TomlReader reader(table, describeTable("file", table), context.file);
  const TomlValue& nameValue = reader.require("name");
  const std::string name = reader.toText(nameValue, "name");
  context.checkName(nameValue, name);
  const TomlValue& pathValue = reader.require("path");
  const std::filesystem::path path = context.resolvePath(pathValue, reader.toText(pathValue, "path"));
  if (sceneFormat(path, {}) == SceneFormat::toml)
    reader.fail(pathValue, "a [[file]] must be a glTF file; scene files cannot include each other");
  const bool lights = reader.boolean("lights", true), cameras = reader.boolean("cameras", true);
  InstanceTarget target;
  target.placedByDefault = reader.boolean("place", true);
  LoadOptions options = context.options;
  const TomlValue *const variant = reader.find("variant"), *const sceneName = reader.find("scene");
  const TomlValue* const animation = reader.find("animation");
  const std::string played = animation ? reader.toText(*animation, "animation") : std::string();
  if (played == "none") options.animation.reset();
  if (options.animation) options.animation = played;
  options.variant = variant ? reader.toText(*variant, "variant") : std::string();
  options.scene = sceneName ? reader.toText(*sceneName, "scene") : std::string();
  reader.rejectUnknownKeys();

  // The key of an unknown name, if it is the only one.
  const TomlValue* named = nullptr;
  for (const TomlValue* const key : {variant, sceneName, animation})
    if (key) named = named ? &pathValue : key;
  Scene part = loadPart(context, reader, path, options, named ? *named : pathValue);
  std::ranges::copy(part.report.files, std::back_inserter(context.scene.report.files));
  Scene& scene = context.scene;
  const std::size_t firstMaterial = scene.materials.size(), firstMesh = scene.meshes.size();
  for (Instance& instance : part.instances) shift(instance.mesh, firstMesh);
  appendAnimation(context.animation, part, firstMaterial);
  target.instances = std::move(part.instances);
  if (lights) target.lights = std::move(part.lights);
  if (cameras) target.cameras = std::move(part.cameras);
  // [environment] has precedence; it is read later.
  if (lights && target.placedByDefault && !scene.environment.present) scene.environment = std::move(part.environment);
  context.addTarget(nameValue, name, std::move(target));
  addNames(context, nameValue, name, part, firstMaterial, firstMesh);
  appendReport(scene.report, part.report, name);
  appendResources(scene, part);
}

}  // namespace

void readFiles(SceneTomlContext& context, TomlReader& root) {
  for (const TomlValue& table : root.tables("file")) readFile(context, table);
}

}  // namespace quintet::scene
