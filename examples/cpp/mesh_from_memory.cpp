// SPDX-License-Identifier: Apache-2.0
// A scene without files: a pyramid with vertex colors on a textured floor, a lamp and a sky. Writes mesh_from_memory.png.
#include <cstdio>
#include <exception>
#include <vector>

#include <quintet/quintet.h>

using quintet::Float2;
using quintet::Float3;
using quintet::Float4;

namespace {

// A checkerboard of 2x2 texels, repeated 4 times in each direction.
int addFloor(quintet::Scene& scene) {
  const std::vector<std::uint8_t> texels{230, 230, 225, 60, 70, 80, 60, 70, 80, 230, 230, 225};
  const int texture = scene.addTexture({.name = "checker",
                                        .width = 2,
                                        .height = 2,
                                        .channels = 3,
                                        .pixels = std::span<const std::uint8_t>(texels),
                                        .filter = quintet::Filter::nearest});
  const int material = scene.addMaterial(
      {.name = "floor", .baseColorTexture = {.texture = texture, .scale = {4, 4}}, .roughness = 0.6f});
  const std::vector<Float3> positions{{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}};
  const std::vector<quintet::UInt3> indices{{0, 1, 2}, {0, 2, 3}};
  const std::vector<Float2> uv{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return scene.addMesh({.positions = positions, .indices = indices, .uv0 = uv, .material = material}, "floor");
}

int addPyramid(quintet::Scene& scene) {
  const int material = scene.addMaterial({.name = "paint", .roughness = 0.3f, .clearcoat = 1.0f});
  const Float3 top{0, 1.6f, 0}, a{-1, 0, 1}, b{1, 0, 1}, c{1, 0, -1}, d{-1, 0, -1};
  const Float4 red{0.8f, 0.1f, 0.05f, 1}, yellow{0.9f, 0.6f, 0.05f, 1};
  // Without indices, every three vertices are a triangle.
  const std::vector<Float3> positions{a, b, top, b, c, top, c, d, top, d, a, top};
  std::vector<Float4> colors;
  for (std::size_t i = 0; i < positions.size(); ++i) colors.push_back(i % 3 == 2 ? yellow : red);
  return scene.addMesh({.positions = positions, .colors = colors, .material = material}, "pyramid");
}

}  // namespace

int main() try {
  quintet::Scene scene;
  scene.addInstance({.mesh = addFloor(scene)});
  scene.addInstance({.mesh = addPyramid(scene), .worldFromObject = quintet::Transform::rotation({0, 1, 0}, 0.5f)});
  scene.addLight({.intensity = {60, 55, 45}, .position = {2, 4, 3}});
  scene.setEnvironment({.radiance = {0.25f, 0.35f, 0.5f}});

  quintet::prepareDrivers();  // before the process has other threads
  quintet::Device device;
  quintet::Renderer renderer(
      device, scene, quintet::Program::load("pathtracer"),
      {.width = 480, .height = 320, .camera = {{.lookFrom = {0, 2.5f, 6}, .lookAt = {0, 0.5f, 0}}}});
  renderer.render(64);
  renderer.image().write("mesh_from_memory.png");
} catch (const std::exception& error) {
  return std::fprintf(stderr, "mesh_from_memory: %s\n", error.what()), 1;
}
