// SPDX-License-Identifier: Apache-2.0
// Lesson 01 with the C++ API: shows which pixels the scene covers. Writes first_ray.png.
#include <cstdio>
#include <exception>

#include <quintet/quintet.h>

int main() try {
  quintet::prepareDrivers();  // before the process has other threads
  quintet::Device device;
  const auto program = quintet::Program::load("lessons/01_first_ray");
  for (const auto& diagnostic : quintet::checkProgram(program)) std::puts(diagnostic.format().c_str());

  quintet::Renderer renderer(device, quintet::Scene::of(program), program, {.width = 480, .height = 320});
  renderer.render(1);
  renderer.image().write("first_ray.png");
  std::printf("first_ray.png, rendered on %s\n", device.name().c_str());
} catch (const std::exception& error) {
  return std::fprintf(stderr, "first_ray: %s\n", error.what()), 1;
}
