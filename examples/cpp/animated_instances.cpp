// SPDX-License-Identifier: Apache-2.0
// Moves instances, a material and the camera between images. Only what changed is rebuilt: the acceleration structures of
// the meshes and the pipeline stay. Writes animated_instances_0.png to animated_instances_3.png.
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <quintet/quintet.h>

int main() try {
  // A scene text (docs/scenes.md) places each mesh once: instance 0 is the ball, instance 1 the ground.
  quintet::Scene scene = quintet::Scene::fromToml(R"(
[[material]]
name = "brass"
base_color = [0.9, 0.65, 0.25]
metallic = 1.0
roughness = 0.25
[[mesh]]
name = "ball"
shape = "uv_sphere"
material = "brass"
[[mesh]]
name = "ground"
shape = "plane"
size = [12, 12]
)");
  constexpr int kBalls = 7;
  std::vector<int> balls{0};
  for (int i = 1; i < kBalls; ++i) balls.push_back(scene.addInstance({.mesh = 0}));
  scene.addLight({.type = quintet::LightType::directional, .intensity = {3, 3, 3}, .direction = {-1, -2, -1}});
  scene.setEnvironment({.radiance = {0.4f, 0.5f, 0.6f}});

  quintet::prepareDrivers();  // before the process has other threads
  quintet::Device device;
  quintet::Renderer renderer(device, scene, quintet::Program::load("pathtracer"), {.width = 320, .height = 200});
  for (int frame = 0; frame < 4; ++frame) {
    for (int i = 0; i < kBalls; ++i) {
      const float angle = 6.2832f * static_cast<float>(i) / kBalls + 0.2f * static_cast<float>(frame);
      const float height = 0.5f + 0.5f * std::abs(std::sin(1.5f * static_cast<float>(frame) + static_cast<float>(i)));
      renderer.setTransform(balls[static_cast<std::size_t>(i)],
                            quintet::Transform::translation({2.2f * std::cos(angle), height, 2.2f * std::sin(angle)}) *
                                quintet::Transform::scaling({0.5f, 0.5f, 0.5f}));
    }
    quintet::Material material = scene.material(0);
    material.roughness = 0.1f + 0.2f * static_cast<float>(frame);
    renderer.setMaterial(0, material);
    renderer.setCamera({.lookFrom = {0.5f * static_cast<float>(frame), 3, 6}, .lookAt = {0, 0.4f, 0}});
    renderer.render(32);
    renderer.image().write("animated_instances_" + std::to_string(frame) + ".png");
  }
} catch (const std::exception& error) {
  return std::fprintf(stderr, "animated_instances: %s\n", error.what()), 1;
}
