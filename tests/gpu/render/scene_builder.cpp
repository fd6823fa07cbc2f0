// SPDX-License-Identifier: Apache-2.0
#include "scene_builder.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <random>
#include <utility>

namespace quintet::test {

scene::Material lambert(const vec3& albedo) {
  scene::Material m;
  m.baseColor = vec4(albedo, 1.0f);
  m.metallic = 0.0f;
  m.specular = 0.0f;
  return m;
}

scene::Material emitter(const vec3& radiance) {
  scene::Material m = lambert(vec3(0.0f));
  m.emissive = radiance;
  return m;
}

scene::Material unlit(const vec3& color, float alpha) {
  scene::Material m = lambert(color);
  m.baseColor.a = alpha;
  m.unlit = true;
  return m;
}

scene::Material clearGlass(float ior, float thickness) {
  scene::Material m;
  m.metallic = 0.0f;
  m.roughness = 0.0f;
  m.transmission = 1.0f;
  m.ior = ior;
  m.thickness = thickness;
  return m;
}

scene::Geometry quad(const vec3& corner, const vec3& a, const vec3& b) {
  scene::Geometry g;
  g.positions = {corner, corner + a, corner + a + b, corner + b};
  g.triangles = {{0, 1, 2}, {0, 2, 3}};
  return g;
}

scene::Geometry box(const vec3& low, const vec3& high) {
  scene::Geometry g;
  for (int i = 0; i < 8; ++i)
    g.positions.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  g.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return g;
}

scene::Geometry sphere(const vec3& center, float radius, int level) {
  const float p = 0.5f * (1.0f + std::sqrt(5.0f));
  scene::Geometry g;
  g.positions = {{-1, p, 0},  {1, p, 0},  {-1, -p, 0}, {1, -p, 0}, {0, -1, p},  {0, 1, p},
                 {0, -1, -p}, {0, 1, -p}, {p, 0, -1},  {p, 0, 1},  {-p, 0, -1}, {-p, 0, 1}};
  g.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (vec3& v : g.positions) v = glm::normalize(v);
  for (; level > 0; --level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, added] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(g.positions.size()));
      if (added) g.positions.push_back(glm::normalize(g.positions[a] + g.positions[b]));
      return entry->second;
    };
    std::vector<uvec3> finer;
    for (const uvec3& t : g.triangles) {
      const uvec3 m(middle(t.x, t.y), middle(t.y, t.z), middle(t.z, t.x));
      finer.insert(finer.end(), {{t.x, m.x, m.z}, {m.x, t.y, m.y}, {m.z, m.y, t.z}, m});
    }
    g.triangles = std::move(finer);
  }
  for (vec3& v : g.positions) v = center + radius * v;
  return g;
}

int addTexel(scene::Scene& scene, const std::vector<std::uint8_t>& rgba, io::ColorEncoding encoding) {
  io::Image image = io::makeImage(static_cast<std::uint32_t>(rgba.size() / 4), 1, 4, io::PixelType::u8, encoding);
  std::ranges::copy(rgba, image.samples<std::uint8_t>().begin());
  scene.images.push_back({"texel", std::move(image)});
  scene.textures.push_back({"texel",
                            static_cast<int>(scene.images.size()) - 1,
                            {scene::Wrap::repeat, scene::Wrap::repeat, scene::Filter::nearest}});
  return static_cast<int>(scene.textures.size()) - 1;
}

scene::Geometry scatteredQuads(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-0.5f, 0.5f);
  const auto point = [&] { return vec3(unit(random), unit(random), unit(random)); };
  scene::Geometry all;
  for (int i = 0; i < count; ++i) {
    const scene::Geometry one = quad(point(), 0.3f * point(), 0.3f * point());
    const auto base = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), one.positions.begin(), one.positions.end());
    for (const uvec3& triangle : one.triangles) all.triangles.push_back(triangle + base);
  }
  return all;
}

SceneBuilder thicket() {
  const mat4 turned = glm::rotate(scaled(-1.0f, 1.2f, 1.0f), 0.4f, vec3(0.3f, 1.0f, 0.1f));
  SceneBuilder scene;
  scene.add(quad({-3, -1, 3}, {6, 0, 0}, {0, 0, -6}), lambert(vec3(0.5f)));
  scene.add(scatteredQuads(150, 1), lambert({0.6f, 0.3f, 0.2f}), turned);
  scene.add(scatteredQuads(400, 2), lambert({0.2f, 0.6f, 0.3f}), turned);
  scene.scene.materials.push_back(emitter(vec3(3.0f)));
  scene::Geometry lights = scatteredQuads(20, 3);
  lights.material = static_cast<int>(scene.scene.materials.size()) - 1;
  scene.scene.meshes[2].geometries.push_back(lights);
  scene.sky(vec3(0.4f)).camera(perspective({0.3f, 0.4f, 2.2f}, {0, 0, 0}, 40.0f));
  return scene;
}

std::shared_ptr<const scene::Scene> boxScene() {
  scene::PrimitiveSet set;
  set.kind = scene::PrimitiveSetKind::custom;
  set.boxes.push_back({{-1.0f, -1.0f, -1.0f}, {1.0f, 1.0f, 1.0f}});
  scene::Scene scene;
  scene.meshes.emplace_back().primitiveSets.push_back(std::move(set));
  scene.instances.emplace_back().mesh = 0;
  return std::make_shared<const scene::Scene>(std::move(scene));
}

SceneBuilder& SceneBuilder::add(scene::Geometry geometry, const scene::Material& material,
                                const mat4& worldFromObject) {
  geometry.material = static_cast<int>(scene.materials.size());
  scene.materials.push_back(material);
  scene::Instance instance;
  instance.mesh = static_cast<int>(scene.meshes.size());
  instance.worldFromObject = worldFromObject;
  scene.instances.push_back(instance);
  scene.meshes.emplace_back().geometries.push_back(std::move(geometry));
  return *this;
}

SceneBuilder& SceneBuilder::light(const scene::Light& light) {
  scene.lights.push_back(light);
  return *this;
}

SceneBuilder& SceneBuilder::sky(const vec3& radiance) {
  environment.constant = radiance;
  environment.present = true;
  return *this;
}

SceneBuilder& SceneBuilder::camera(const scene::Camera& camera) {
  scene.cameras = {camera};
  return *this;
}

mat4 moved(float x, float y, float z) { return glm::translate(mat4(1.0f), vec3(x, y, z)); }

mat4 scaled(float x, float y, float z) { return glm::scale(mat4(1.0f), vec3(x, y, z)); }

mat4 lookAt(const vec3& eye, const vec3& target) {
  const vec3 view = glm::normalize(target - eye);
  const vec3 up = std::abs(view.y) > 0.999f ? vec3(0, 0, -1) : vec3(0, 1, 0);
  const vec3 x = glm::normalize(glm::cross(view, up));
  return mat4(vec4(x, 0), vec4(glm::cross(x, view), 0), vec4(-view, 0), vec4(eye, 1));
}

scene::Camera perspective(const vec3& eye, const vec3& target, float verticalFovDegrees) {
  scene::Camera camera;
  camera.verticalFov = glm::radians(verticalFovDegrees);
  camera.worldFromCamera = lookAt(eye, target);
  return camera;
}

scene::Camera orthographic(const vec3& eye, const vec3& target, float halfSize) {
  scene::Camera camera;
  camera.orthographic = true;
  camera.orthographicHalfSize = vec2(halfSize);
  camera.worldFromCamera = lookAt(eye, target);
  return camera;
}

}  // namespace quintet::test
