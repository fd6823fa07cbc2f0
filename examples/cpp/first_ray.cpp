// Lesson 01 through the library: which pixels does the scene cover? Writes first_ray.png.
#include <cstdio>
#include <exception>

#include <quintet/quintet.h>

int main() try {
  quintet::Device device;
  const auto program = quintet::Program::load("lessons/01_first_ray");
  for (const auto& diagnostic : quintet::check(program)) std::puts(diagnostic.format().c_str());

  quintet::Renderer renderer(device, quintet::Scene::of(program), program, {.width = 480, .height = 320});
  renderer.render(1);
  renderer.picture().write("first_ray.png");
  std::printf("first_ray.png, rendered on %s\n", device.name().c_str());
} catch (const std::exception& error) {
  return std::fprintf(stderr, "first_ray: %s\n", error.what()), 1;
}
