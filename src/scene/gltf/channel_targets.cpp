// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/channel_targets.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <optional>
#include <string_view>

#include "scene/animation/properties.h"
#include "scene/gltf/extensions.h"

namespace quintet::scene {
namespace {

constexpr std::size_t kShownCharacters = 100;  // of pointers in messages

std::optional<AnimatedProperty> propertyOf(std::string_view path) {
  if (path == "translation") return AnimatedProperty::translation;
  if (path == "rotation") return AnimatedProperty::rotation;
  if (path == "scale") return AnimatedProperty::scale;
  if (path == "weights") return AnimatedProperty::weights;
  return std::nullopt;
}

ResolvedChannel problem(std::string text) { return {.targets = {}, .location = {}, .problem = std::move(text)}; }

ResolvedChannel resolveNode(const Document& document, int index, AnimatedProperty property) {
  const tinygltf::Node& node = document.model.nodes[static_cast<std::size_t>(index)];
  ChannelTarget target{ChannelTarget::Object::node, index, static_cast<std::size_t>(property), 3};
  switch (property) {
    case AnimatedProperty::visibility: target.size = 1; break;
    case AnimatedProperty::weights:
      target.size = morphTargetCount(document, node);
      if (target.size == 0) return problem(fmt::format("node {} has no morph targets", index));
      break;
    default:
      if (property == AnimatedProperty::rotation) target.size = 4;
      if (!node.matrix.empty()) return problem(fmt::format("node {} has a matrix, which cannot be animated", index));
  }
  return {.targets = {target}, .location = {}, .problem = {}};
}

// ---- KHR_animation_pointer ----

// The weights of a mesh are those of its nodes that have none of their own.
ResolvedChannel resolveMesh(const Document& document, int index) {
  ResolvedChannel resolved;
  for (std::size_t i = 0; i < document.model.nodes.size(); ++i) {
    const tinygltf::Node& node = document.model.nodes[i];
    if (node.mesh != index || !node.weights.empty()) continue;
    const ResolvedChannel one = resolveNode(document, static_cast<int>(i), AnimatedProperty::weights);
    if (!one.problem.empty()) return one;
    resolved.targets.push_back(one.targets[0]);
  }
  if (resolved.targets.empty()) resolved.problem = fmt::format("no node uses the weights of mesh {}", index);
  return resolved;
}

ResolvedChannel resolveMaterial(const Document& document, const std::vector<Material>& materials, int index,
                                std::string_view pointer) {
  const std::optional<PropertyInfo> property = findMaterialProperty(pointer);
  if (!property) return problem("the property is unknown or has no effect on the image");
  const auto i = static_cast<std::size_t>(index);
  if (document.model.materials[i].extensions.contains("KHR_materials_pbrSpecularGlossiness"))
    return problem(fmt::format("material {} is converted from KHR_materials_pbrSpecularGlossiness", index));
  if (property->texture && !(materials[i].*property->texture).used())
    return problem(fmt::format("material {} does not use this texture", index));
  return {.targets = {{ChannelTarget::Object::material, index, property->index, property->size}},
          .location = {},
          .problem = {}};
}

ResolvedChannel resolveLight(int index, std::string_view pointer) {
  const std::optional<PropertyInfo> property = findLightProperty(pointer);
  if (!property) return problem("the property is unknown or has no effect on the image");
  return {.targets = {{ChannelTarget::Object::light, index, property->index, property->size}},
          .location = {},
          .problem = {}};
}

ResolvedChannel resolveCamera(const Document& document, int index, std::string_view pointer) {
  const std::optional<PropertyInfo> property = findCameraProperty(pointer);
  if (pointer == "perspective/aspectRatio") return problem("the size of the image does not change");
  if (!property) return problem("the property is unknown or has no effect on the image");
  const std::string& type = document.model.cameras[static_cast<std::size_t>(index)].type;
  if (!pointer.starts_with(type + "/")) return problem(fmt::format("camera {} is {}", index, type));
  return {.targets = {{ChannelTarget::Object::camera, index, property->index, property->size}},
          .location = {},
          .problem = {}};
}

// A prefix of pointers to objects of the file.
struct PointedCollection {
  std::string_view prefix;
  std::string_view noun;
};
constexpr auto kCollections = std::to_array<PointedCollection>({{"/nodes/", "node"},
                                                                {"/materials/", "material"},
                                                                {"/meshes/", "mesh"},
                                                                {"/cameras/", "camera"},
                                                                {"/extensions/KHR_lights_punctual/lights/", "light"}});

std::size_t countOf(const Document& document, std::string_view noun) {
  if (noun == "node") return document.model.nodes.size();
  if (noun == "material") return document.model.materials.size();
  if (noun == "mesh") return document.model.meshes.size();
  return noun == "camera" ? document.model.cameras.size() : document.model.lights.size();
}

ResolvedChannel resolvePointer(const Document& document, const std::vector<Material>& materials,
                               std::string_view pointer) {
  for (const PointedCollection& collection : kCollections) {
    if (!pointer.starts_with(collection.prefix)) continue;
    const std::string_view rest = pointer.substr(collection.prefix.size());
    int index = -1;
    const auto [stop, error] = std::from_chars(rest.data(), rest.data() + rest.size(), index);
    const auto digits = static_cast<std::size_t>(stop - rest.data());
    if (error != std::errc{} || index < 0 || digits >= rest.size() || rest[digits] != '/') break;
    if (static_cast<std::size_t>(index) >= countOf(document, collection.noun))
      return problem(fmt::format("{} {} does not exist", collection.noun, index));
    const std::string_view property = rest.substr(digits + 1);
    if (collection.noun == "material") return resolveMaterial(document, materials, index, property);
    if (collection.noun == "light") return resolveLight(index, property);
    if (collection.noun == "camera") return resolveCamera(document, index, property);
    if (collection.noun == "mesh" && property == "weights") return resolveMesh(document, index);
    if (collection.noun == "mesh") break;
    if (property == "extensions/KHR_node_visibility/visible")
      return resolveNode(document, index, AnimatedProperty::visibility);
    if (const std::optional<AnimatedProperty> of = propertyOf(property)) return resolveNode(document, index, *of);
    break;
  }
  return problem("the property is unknown or has no effect on the image");
}

const std::string* pointerOf(const tinygltf::AnimationChannel& channel) {
  const tinygltf::Value* extension = findExtension(channel.target_extensions, kAnimationPointer);
  return extension ? &extension->Get("pointer").Get<std::string>() : nullptr;
}

}  // namespace

std::size_t morphTargetCount(const Document& document, const tinygltf::Node& node) {
  if (node.mesh == kNone) return 0;
  const auto& primitives = document.model.meshes[static_cast<std::size_t>(node.mesh)].primitives;
  return primitives.empty() ? 0 : primitives[0].targets.size();
}

ResolvedChannel resolveChannel(const Document& document, const std::vector<Material>& materials,
                               const tinygltf::AnimationChannel& channel) {
  if (const std::string* pointer = pointerOf(channel); pointer && channel.target_path == "pointer") {
    ResolvedChannel resolved = resolvePointer(document, materials, *pointer);
    resolved.location = fmt::format("/extensions/{}/pointer", kAnimationPointer);
    if (!resolved.problem.empty())
      resolved.problem = fmt::format("\"{}\": {}", pointer->substr(0, kShownCharacters), resolved.problem);
    return resolved;
  }
  const std::optional<AnimatedProperty> property = propertyOf(channel.target_path);
  if (!property) return problem(fmt::format("path \"{}\" is not supported", channel.target_path.substr(0, 40)));
  if (channel.target_node == kNone) return problem("no target node");
  return resolveNode(document, channel.target_node, *property);
}

std::string describeTarget(const tinygltf::AnimationChannel& channel) {
  if (const std::string* pointer = pointerOf(channel)) return pointer->substr(0, kShownCharacters);
  return fmt::format("the {} of node {}", channel.target_path, channel.target_node);
}

}  // namespace quintet::scene
