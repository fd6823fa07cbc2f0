#include "scene/validate.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace quintet::scene {
namespace {

template <class... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error("scene: " + fmt::format(format, std::forward<Args>(args)...));
}

bool inRange(int index, std::size_t size) { return index >= 0 && static_cast<std::size_t>(index) < size; }

bool isFinite(const mat4& m) {
  for (std::size_t column = 0; column < 4; ++column)
    if (!quintet::isFinite(vec3(m[column])) || !std::isfinite(m[column].w)) return false;
  return true;
}

void checkGeometry(const Scene& scene, const Geometry& geometry, const std::string& name) {
  const std::size_t count = geometry.positions.size();
  const auto checkLength = [&](std::size_t length, const char* attribute) {
    if (length != 0 && length != count) fail("{}.{}: {} elements for {} vertices", name, attribute, length, count);
  };
  checkLength(geometry.normals.size(), "normals");
  checkLength(geometry.tangents.size(), "tangents");
  checkLength(geometry.colors.size(), "colors");
  for (const auto& set : geometry.uvs) checkLength(set.size(), "uvs");
  if (!geometry.tangents.empty() && geometry.normals.empty()) fail("{}.tangents: without normals", name);
  if (!geometry.fileTriangles.empty() && geometry.fileTriangles.size() != geometry.triangles.size())
    fail("{}.fileTriangles: {} for {} triangles", name, geometry.fileTriangles.size(), geometry.triangles.size());
  if (geometry.material != kNone && !inRange(geometry.material, scene.materials.size()))
    fail("{}.material: {} of {}", name, geometry.material, scene.materials.size());
  for (std::size_t i = 0; i < geometry.triangles.size(); ++i) {
    const uvec3& t = geometry.triangles[i];
    if (std::max({t.x, t.y, t.z}) >= count)
      fail("{}.triangles[{}]: vertex {} of {}", name, i, std::max({t.x, t.y, t.z}), count);
  }
  const auto wrong = std::ranges::find_if_not(geometry.positions, [](const vec3& p) { return quintet::isFinite(p); });
  if (wrong != geometry.positions.end()) fail("{}.positions[{}]: not finite", name, wrong - geometry.positions.begin());
}

void checkMaterial(const Scene& scene, const Material& material, const std::string& name) {
  for (const TextureUse* use : {&material.baseColorTexture, &material.metallicRoughnessTexture, &material.normalTexture,
                                &material.occlusionTexture, &material.emissiveTexture, &material.transmissionTexture,
                                &material.specularTexture, &material.specularColorTexture, &material.clearcoatTexture,
                                &material.clearcoatRoughnessTexture, &material.clearcoatNormalTexture}) {
    if (!use->used()) continue;
    if (!inRange(use->texture, scene.textures.size()))
      fail("{}: texture {} of {}", name, use->texture, scene.textures.size());
    if (!inRange(use->uvSet, kMaxUvSets)) fail("{}: texture coordinate set {} of {}", name, use->uvSet, kMaxUvSets);
  }
  if (!(material.attenuationDistance > 0.0f)) fail("{}.attenuationDistance: {}", name, material.attenuationDistance);
}

void checkImage(const io::Image& image, const std::string& name) {
  if (image.empty() || image.channels < 1 || image.channels > 4 || image.data.size() != image.height * image.rowBytes())
    fail("{}: {} bytes for {} x {} pixels of {} channels", name, image.data.size(), image.width, image.height,
         image.channels);
}

}  // namespace

void validate(const Scene& scene) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i)
    for (std::size_t k = 0; k < scene.meshes[i].geometries.size(); ++k)
      checkGeometry(scene, scene.meshes[i].geometries[k], fmt::format("meshes[{}].geometries[{}]", i, k));
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (!inRange(instance.mesh, scene.meshes.size()))
      fail("instances[{}].mesh: {} of {}", i, instance.mesh, scene.meshes.size());
    if (!isFinite(instance.worldFromObject)) fail("instances[{}].worldFromObject: not finite", i);
    if (glm::determinant(glm::dmat3(glm::mat3(instance.worldFromObject))) == 0.0)
      fail("instances[{}].worldFromObject: no inverse", i);
  }
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    checkMaterial(scene, scene.materials[i], fmt::format("materials[{}]", i));
  for (std::size_t i = 0; i < scene.textures.size(); ++i)
    if (!inRange(scene.textures[i].image, scene.images.size()))
      fail("textures[{}].image: {} of {}", i, scene.textures[i].image, scene.images.size());
  for (std::size_t i = 0; i < scene.images.size(); ++i) checkImage(scene.images[i].image, fmt::format("images[{}]", i));
  for (std::size_t i = 0; i < scene.cameras.size(); ++i)
    if (!isFinite(scene.cameras[i].worldFromCamera)) fail("cameras[{}].worldFromCamera: not finite", i);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    if (!quintet::isFinite(light.intensity) || !quintet::isFinite(light.position) ||
        !quintet::isFinite(light.direction))
      fail("lights[{}]: not finite", i);
  }
  if (!scene.environment.image.empty()) checkImage(scene.environment.image, "environment.image");
}

}  // namespace quintet::scene
