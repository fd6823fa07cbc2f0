// SPDX-License-Identifier: Apache-2.0
#include "scene/defaults/default_scene.h"

#include <cmath>
#include <utility>

#include "scene/defaults/default_environment.h"

namespace quintet::scene {
namespace {

constexpr std::uint32_t kSphereColumns = 48, kSphereRows = 24;

int addMaterial(Scene& scene, const char* name, vec3 color, float roughness, float metallic) {
  Material material;
  material.name = name;
  material.baseColor = vec4(color, 1.0f);
  material.roughness = roughness;
  material.metallic = metallic;
  scene.materials.push_back(material);
  return static_cast<int>(scene.materials.size()) - 1;
}

int addMesh(Scene& scene, const char* name, Geometry geometry) {
  Mesh mesh;
  mesh.name = name;
  mesh.geometries.push_back(std::move(geometry));
  scene.meshes.push_back(std::move(mesh));
  return static_cast<int>(scene.meshes.size()) - 1;
}

void addInstance(Scene& scene, const char* name, int mesh, vec3 position, float scale, float turn = 0.0f) {
  Instance instance;
  instance.name = name;
  instance.mesh = mesh;
  instance.worldFromObject =
      glm::scale(glm::rotate(glm::translate(mat4(1.0f), position), turn, vec3(0, 1, 0)), vec3(scale));
  instance.customIndex = static_cast<std::uint32_t>(scene.instances.size());
  scene.instances.push_back(instance);
}

// Adds a square. `right` and `up` are half its sides; the normal is their cross product.
void addQuad(Geometry& geometry, vec3 center, vec3 right, vec3 up) {
  const auto first = static_cast<std::uint32_t>(geometry.positions.size());
  const vec3 normal = glm::normalize(glm::cross(right, up));
  for (const vec2 corner : {vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, 1)}) {
    geometry.positions.push_back(center + corner.x * right + corner.y * up);
    geometry.normals.push_back(normal);
    geometry.uvs[0].push_back({0.5f + 0.5f * corner.x, 0.5f - 0.5f * corner.y});
  }
  geometry.triangles.emplace_back(first, first + 1, first + 2);
  geometry.triangles.emplace_back(first, first + 2, first + 3);
}

Geometry floor() {
  Geometry geometry;
  addQuad(geometry, vec3(0.0f), {4, 0, 0}, {0, 0, -4});
  return geometry;
}

Geometry cube() {
  Geometry geometry;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {1.0f, -1.0f}) {
      vec3 normal(0.0f), right(0.0f);
      normal[axis] = side;
      right[(axis + 1) % 3] = 1.0f;
      addQuad(geometry, normal, right, glm::cross(normal, right));
    }
  }
  return geometry;
}

// Radius 1.
Geometry sphere() {
  Geometry geometry;
  for (std::uint32_t row = 0; row <= kSphereRows; ++row) {
    for (std::uint32_t column = 0; column <= kSphereColumns; ++column) {
      const vec2 uv(static_cast<float>(column) / kSphereColumns, static_cast<float>(row) / kSphereRows);
      const float phi = 2.0f * kPi * uv.x;
      const float theta = kPi * uv.y;
      const vec3 point(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
      geometry.positions.push_back(point);
      geometry.normals.push_back(glm::normalize(point));
      geometry.uvs[0].push_back(uv);
    }
  }
  const auto vertex = [](std::uint32_t row, std::uint32_t column) { return row * (kSphereColumns + 1) + column; };
  for (std::uint32_t row = 0; row < kSphereRows; ++row) {
    for (std::uint32_t column = 0; column < kSphereColumns; ++column) {
      const std::uint32_t a = vertex(row, column), b = vertex(row + 1, column);
      if (row + 1 < kSphereRows) geometry.triangles.emplace_back(a, b, b + 1);
      if (row > 0) geometry.triangles.emplace_back(a, b + 1, a + 1);
    }
  }
  return geometry;
}

void addTriangles(Scene& scene) {
  Geometry ground = floor(), ball = sphere(), mirror = sphere(), block = cube();
  ground.material = addMaterial(scene, "floor", {0.40f, 0.40f, 0.38f}, 0.9f, 0.0f);
  ball.material = addMaterial(scene, "red", {0.72f, 0.12f, 0.08f}, 0.4f, 0.0f);
  block.material = addMaterial(scene, "blue", {0.10f, 0.25f, 0.65f}, 0.6f, 0.0f);
  mirror.material = addMaterial(scene, "mirror", {0.95f, 0.93f, 0.88f}, 0.0f, 1.0f);
  addInstance(scene, "floor", addMesh(scene, "floor", std::move(ground)), {0, 0, 0}, 1.0f);
  addInstance(scene, "ball", addMesh(scene, "ball", std::move(ball)), {-1.1f, 1.0f, 0.2f}, 1.0f);
  addInstance(scene, "cube", addMesh(scene, "cube", std::move(block)), {1.3f, 0.7f, -0.6f}, 0.7f, 0.5f);
  addInstance(scene, "mirror", addMesh(scene, "mirror", std::move(mirror)), {0.7f, 0.5f, 1.2f}, 0.5f);
}

void addBoxes(Scene& scene) {
  Mesh mesh;
  mesh.name = "boxes";
  PrimitiveSet set;
  set.name = "boxes";
  set.kind = PrimitiveSetKind::custom;
  set.boxes.push_back(Bounds3{vec3(-1.0f), vec3(1.0f)});
  set.material = addMaterial(scene, "box", {0.85f, 0.55f, 0.15f}, 0.5f, 0.0f);
  mesh.primitiveSets.push_back(std::move(set));
  scene.meshes.push_back(std::move(mesh));
  // Behind the triangles, near the center of the view.
  addInstance(scene, "box", static_cast<int>(scene.meshes.size()) - 1, {0.0f, 1.0f, -1.6f}, 1.0f);
}

}  // namespace

Scene defaultScene(const DefaultSceneOptions& options) {
  Scene scene;
  scene.name = "default scene";
  if (options.triangles) addTriangles(scene);
  if (options.boxes) addBoxes(scene);

  Camera camera;
  camera.name = "default";
  camera.verticalFov = glm::radians(40.0f);
  const vec3 eye(2.2f, 2.6f, 6.0f), target(0.0f, 0.8f, 0.0f);
  camera.worldFromCamera = glm::inverse(glm::lookAtRH(eye, target, vec3(0, 1, 0)));
  camera.focusDistance = glm::length(target - eye);
  scene.cameras.push_back(camera);

  Light sun;
  sun.name = "sun";
  sun.type = LightType::directional;
  sun.intensity = vec3(2.0f, 1.93f, 1.8f);
  sun.direction = glm::normalize(vec3(-0.5f, -1.0f, -0.4f));
  scene.lights.push_back(sun);
  scene.environment = defaultEnvironment();
  return scene;
}

}  // namespace quintet::scene
