// SPDX-License-Identifier: Apache-2.0
#include "scene/model/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/plural.h"
#include "scene/model/limits.h"
#include "scene/model/material_textures.h"

namespace quintet::scene {
namespace {

template <class... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error("scene: " + fmt::format(format, std::forward<Args>(args)...));
}

// "materials[2] 'steel'", so that messages show the object to those who know only one of them.
std::string objectName(const char* list, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{}[{}]", list, index) : fmt::format("{}[{}] '{}'", list, index, name);
}

bool inRange(int index, std::size_t size) { return index >= 0 && static_cast<std::size_t>(index) < size; }

void checkGeometry(const Scene& scene, const Geometry& geometry, const std::string& name) {
  const std::size_t count = geometry.positions.size();
  const auto checkLength = [&](std::size_t length, const char* attribute) {
    if (length != 0 && length != count)
      fail("{}.{}: {} for {}", name, attribute, counted(length, "element"), counted(count, "vertex", "vertices"));
  };
  checkLength(geometry.normals.size(), "normals");
  checkLength(geometry.tangents.size(), "tangents");
  checkLength(geometry.colors.size(), "colors");
  for (const auto& set : geometry.uvs) checkLength(set.size(), "uvs");
  if (!geometry.tangents.empty() && geometry.normals.empty()) fail("{}.tangents: present without normals", name);
  if (!geometry.fileTriangles.empty() && geometry.fileTriangles.size() != geometry.triangles.size())
    fail("{}.fileTriangles: {} for {}", name, geometry.fileTriangles.size(),
         counted(geometry.triangles.size(), "triangle"));
  if (geometry.material != kNone && !inRange(geometry.material, scene.materials.size()))
    fail("{}.material: {} of {}", name, geometry.material, scene.materials.size());
  for (std::size_t i = 0; i < geometry.triangles.size(); ++i) {
    const uvec3& t = geometry.triangles[i];
    if (std::max({t.x, t.y, t.z}) >= count)
      fail("{}.triangles[{}]: vertex {} of {}", name, i, std::max({t.x, t.y, t.z}), count);
  }
  const auto wrong = std::ranges::find_if_not(geometry.positions, [](const vec3& p) { return isFinite(p); });
  if (wrong != geometry.positions.end()) fail("{}.positions[{}]: not finite", name, wrong - geometry.positions.begin());
  const auto far = std::ranges::find_if_not(geometry.positions, [](const vec3& p) { return isWithinLimits(p); });
  if (far != geometry.positions.end())
    fail("{}.positions[{}]: a coordinate is above {:g}", name, far - geometry.positions.begin(), kMaxCoordinate);
}

// The matrix must be affine and finite, with a finite inverse.
void checkTransform(const mat4& m, const std::string& name) {
  if (!isFinite(m)) fail("{}: not finite", name);
  if (glm::vec4(m[0].w, m[1].w, m[2].w, m[3].w) != vec4(0, 0, 0, 1)) fail("{}: not affine", name);
  const glm::dmat4 d(m);
  if (glm::determinant(glm::dmat3(d)) == 0.0 || !isFinite(mat4(glm::inverse(d)))) fail("{}: singular", name);
}

void checkPrimitive(const Scene& scene, const Primitive& primitive, const std::string& name) {
  if (primitive.type > PrimitiveType::torus) fail("{}.type: {}", name, static_cast<unsigned>(primitive.type));
  checkTransform(primitive.objectFromPrimitive, name + ".objectFromPrimitive");
  if (primitive.type == PrimitiveType::torus && !(primitive.parameter > 0.0f && primitive.parameter < 1.0f))
    fail("{}.parameter: the minor radius of a torus is {}, must be between 0 and 1", name, primitive.parameter);
  if (primitive.material != kNone && !inRange(primitive.material, scene.materials.size()))
    fail("{}.material: {} of {}", name, primitive.material, scene.materials.size());
}

void checkTree(const PrimitiveSet& set, const CsgTree& tree, const std::string& name) {
  if (tree.firstNode > set.nodes.size() || tree.nodeCount > set.nodes.size() - tree.firstNode)
    fail("{}: nodes {} to {} of {}", name, tree.firstNode, std::uint64_t{tree.firstNode} + tree.nodeCount,
         set.nodes.size());
  const auto nodes = std::span(set.nodes).subspan(tree.firstNode, tree.nodeCount);
  if (const std::string problem = csgProblem(nodes, set.primitives.size()); !problem.empty())
    fail("{}: {}", name, problem);
}

void checkPrimitiveSet(const Scene& scene, const PrimitiveSet& set, const std::string& name) {
  const bool solids = set.kind == PrimitiveSetKind::solids, csg = set.kind == PrimitiveSetKind::csg;
  if (set.kind > PrimitiveSetKind::custom) fail("{}.kind: {}", name, static_cast<unsigned>(set.kind));
  if (!csg && (!set.trees.empty() || !set.nodes.empty())) fail("{}: trees in a set that is not csg", name);
  if ((solids || csg) ? !set.boxes.empty() : !set.primitives.empty())
    fail("{}: boxes in a set of solids, or solids in a custom set", name);
  if (set.material != kNone && !inRange(set.material, scene.materials.size()))
    fail("{}.material: {} of {}", name, set.material, scene.materials.size());
  for (std::size_t i = 0; i < set.primitives.size(); ++i)
    checkPrimitive(scene, set.primitives[i], fmt::format("{}.primitives[{}]", name, i));
  for (std::size_t i = 0; i < set.trees.size(); ++i) checkTree(set, set.trees[i], fmt::format("{}.trees[{}]", name, i));
  for (std::size_t i = 0; i < set.boxes.size(); ++i) {
    const Bounds3& box = set.boxes[i];
    if (!isFinite(box.min) || !isFinite(box.max)) fail("{}.boxes[{}]: not finite", name, i);
    if (box.empty()) fail("{}.boxes[{}]: the minimum is above the maximum", name, i);
  }
}

void checkMesh(const Scene& scene, const Mesh& mesh, const std::string& name) {
  if (!mesh.geometries.empty() && mesh.procedural()) fail("{}: triangles and primitive sets in one mesh", name);
  for (std::size_t k = 0; k < mesh.geometries.size(); ++k)
    checkGeometry(scene, mesh.geometries[k], fmt::format("{}.geometries[{}]", name, k));
  for (std::size_t k = 0; k < mesh.primitiveSets.size(); ++k)
    checkPrimitiveSet(scene, mesh.primitiveSets[k], fmt::format("{}.primitiveSets[{}]", name, k));
}

void checkKeyframes(const std::vector<Keyframe>& keys, const std::string& name) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Keyframe& key = keys[i];
    const glm::quat& q = key.rotation;
    if (!std::isfinite(key.frame) || !isFinite(key.translation) || !isFinite(key.scale) ||
        !(std::abs(glm::length(q) - 1.0f) < 1e-3f))
      fail("{}[{}]: not finite, or the rotation is not normalized", name, i);
    if (i > 0 && !(key.frame > keys[i - 1].frame)) fail("{}[{}]: frames must ascend", name, i);
    // A scale that changes its sign passes through 0, where the transform is singular.
    for (int axis = 0; axis < 3; ++axis)
      if (!(key.scale[axis] * keys[0].scale[axis] > 0.0f)) fail("{}[{}]: a scale is 0 or changes its sign", name, i);
  }
}

void checkInstance(const Scene& scene, const Instance& instance, const std::string& name) {
  if (!inRange(instance.mesh, scene.meshes.size())) fail("{}.mesh: {} of {}", name, instance.mesh, scene.meshes.size());
  if (!isFinite(instance.worldFromObject)) fail("{}.worldFromObject: not finite", name);
  if (!isWithinLimits(instance.worldFromObject))
    fail("{}.worldFromObject: a number is above {:g}", name, kMaxCoordinate);
  // A moving instance that is flattened or hidden is not visible at that frame.
  if (!instance.animated() && glm::determinant(glm::dmat3(glm::mat3(instance.worldFromObject))) == 0.0)
    fail("{}.worldFromObject: singular", name);
  if (instance.mask > 0xFF) fail("{}.mask: {} has more than 8 bits", name, instance.mask);
  if (instance.flags > 0xF) fail("{}.flags: {} is unknown", name, instance.flags);
  if (instance.customIndex > 0xFFFFFF) fail("{}.customIndex: {} has more than 24 bits", name, instance.customIndex);
  checkKeyframes(instance.keyframes, name + ".keyframes");
}

void checkMaterial(const Scene& scene, const Material& material, const std::string& name) {
  for (const MaterialTexture& texture : kMaterialTextures) {
    const TextureUse& use = material.*texture.use;
    if (!use.used()) continue;
    if (!inRange(use.texture, scene.textures.size()))
      fail("{}: texture {} of {}", name, use.texture, scene.textures.size());
    if (!inRange(use.uvSet, kMaxUvSets)) fail("{}: texture coordinate set {} of {}", name, use.uvSet, kMaxUvSets);
    if (!isFinite(vec3(use.offset, use.rotation)) || !isFinite(vec3(use.scale, 0.0f)))
      fail("{}: the transform of texture {} is not finite", name, use.texture);
  }
  const auto checkRange = [&](float value, float min, float max, const char* property) {
    if (!(value >= min && value <= max)) fail("{}.{}: {:g} is not in [{:g}, {:g}]", name, property, value, min, max);
  };
  const auto checkUnit = [&](float value, const char* property) { checkRange(value, 0.0f, 1.0f, property); };
  constexpr float kLargest = std::numeric_limits<float>::max();
  for (int i = 0; i < 4; ++i) checkUnit(material.baseColor[i], "baseColor");
  checkUnit(material.metallic, "metallic");
  checkUnit(material.roughness, "roughness");
  checkUnit(material.transmission, "transmission");
  checkUnit(material.specular, "specular");
  checkUnit(material.clearcoat, "clearcoat");
  checkUnit(material.clearcoatRoughness, "clearcoatRoughness");
  checkUnit(material.sheenRoughness, "sheenRoughness");
  checkUnit(material.diffuseTransmission, "diffuseTransmission");
  checkUnit(material.anisotropy, "anisotropy");
  checkUnit(material.iridescence, "iridescence");
  for (int i = 0; i < 3; ++i) {
    checkRange(material.emissive[i], 0.0f, kMaxRadiance, "emissive");
    checkRange(material.specularColor[i], 0.0f, kLargest, "specularColor");
    checkUnit(material.attenuationColor[i], "attenuationColor");
    checkUnit(material.multiscatterColor[i], "multiscatterColor");
    checkUnit(material.sheenColor[i], "sheenColor");
    checkUnit(material.diffuseTransmissionColor[i], "diffuseTransmissionColor");
  }
  checkRange(material.scatterAnisotropy, -1.0f, 1.0f, "scatterAnisotropy");
  checkRange(material.thickness, 0.0f, kLargest, "thickness");
  checkRange(material.iridescenceIor, 1.0f, kLargest, "iridescenceIor");
  checkRange(material.iridescenceThicknessMinimum, 0.0f, kLargest, "iridescenceThicknessMinimum");
  checkRange(material.iridescenceThicknessMaximum, 0.0f, kLargest, "iridescenceThicknessMaximum");
  checkRange(material.dispersion, 0.0f, kLargest, "dispersion");
  for (const auto& [value, property] :
       {std::pair(material.normalScale, "normalScale"),
        std::pair(material.clearcoatNormalScale, "clearcoatNormalScale"),
        std::pair(material.alphaCutoff, "alphaCutoff"), std::pair(material.anisotropyRotation, "anisotropyRotation"),
        std::pair(material.dielectricPriority, "dielectricPriority")})
    if (!std::isfinite(value)) fail("{}.{}: not finite", name, property);
  if (material.ior != 0.0f) checkRange(material.ior, 1.0f, kLargest, "ior");
  if (!(material.attenuationDistance > 0.0f)) fail("{}.attenuationDistance: {}", name, material.attenuationDistance);
}

void checkImage(const io::Image& image, const std::string& name) {
  if (image.empty() || image.channels < 1 || image.channels > 4 || image.data.size() != image.height * image.rowBytes())
    fail("{}: {} for {} x {} pixels of {}", name, counted(image.data.size(), "byte"), image.width, image.height,
         counted(image.channels, "channel"));
}

}  // namespace

void validateMesh(const Scene& scene, std::size_t index) {
  checkMesh(scene, scene.meshes[index], objectName("meshes", index, scene.meshes[index].name));
}

void validateInstance(const Scene& scene, std::size_t index) {
  checkInstance(scene, scene.instances[index], objectName("instances", index, scene.instances[index].name));
}

void validateMaterial(const Scene& scene, std::size_t index) {
  checkMaterial(scene, scene.materials[index], objectName("materials", index, scene.materials[index].name));
}

void validateTexture(const Scene& scene, std::size_t index) {
  const int image = scene.textures[index].image;
  if (!inRange(image, scene.images.size()))
    fail("{}.image: {} of {}", objectName("textures", index, scene.textures[index].name), image, scene.images.size());
  checkImage(scene.images[static_cast<std::size_t>(image)].image, fmt::format("images[{}]", image));
}

void validateCamera(const Scene& scene, std::size_t index) {
  const Camera& camera = scene.cameras[index];
  if (!isFinite(camera.worldFromCamera))
    fail("{}.worldFromCamera: not finite", objectName("cameras", index, camera.name));
  if (!isWithinLimits(camera.worldFromCamera))
    fail("{}.worldFromCamera: a coordinate is above {:g}", objectName("cameras", index, camera.name), kMaxCoordinate);
}

void validateLight(const Scene& scene, std::size_t index) {
  const Light& light = scene.lights[index];
  if (!isFinite(light.intensity) || !isFinite(light.position) || !isFinite(light.direction))
    fail("{}: not finite", objectName("lights", index, light.name));
  if (!isWithinLimits(light.position))
    fail("{}: a coordinate of the position is above {:g}", objectName("lights", index, light.name), kMaxCoordinate);
  if (!(std::max({light.intensity.x, light.intensity.y, light.intensity.z}) <= kMaxRadiance))
    fail("{}: the intensity must be at most {:g}", objectName("lights", index, light.name), kMaxRadiance);
  if (!(light.range > 0.0f)) fail("{}: the range must be above 0", objectName("lights", index, light.name));
  constexpr float kRounding = 1e-6f;
  const float inner = light.innerConeAngle, outer = light.outerConeAngle;
  if (light.type == LightType::spot && !(inner >= 0.0f && inner <= outer && outer <= kPi / 2.0f + kRounding))
    fail("{}: the cone angles must be 0 ≤ inner ≤ outer ≤ 90 degrees, not {:g} and {:g}",
         objectName("lights", index, light.name), glm::degrees(inner), glm::degrees(outer));
}

void validateEnvironment(const Scene& scene) {
  const vec3& constant = scene.environment.constant;
  if (!(glm::all(glm::greaterThanEqual(constant, vec3(0.0f))) &&
        glm::all(glm::lessThanEqual(constant, vec3(kMaxRadiance)))))
    fail("environment: the radiance must be from 0 to {:g}", kMaxRadiance);
  if (!scene.environment.image.empty()) checkImage(scene.environment.image, "environment.image");
}

void validate(const Scene& scene) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) validateMesh(scene, i);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) validateInstance(scene, i);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) validateMaterial(scene, i);
  for (std::size_t i = 0; i < scene.images.size(); ++i) checkImage(scene.images[i].image, fmt::format("images[{}]", i));
  for (std::size_t i = 0; i < scene.textures.size(); ++i) validateTexture(scene, i);
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) validateCamera(scene, i);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) validateLight(scene, i);
  validateEnvironment(scene);
}

}  // namespace quintet::scene
