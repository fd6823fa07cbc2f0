// Lesson 01 through the library: which pixels does the scene cover? Writes first_ray.png.
#include <cstdio>
#include <exception>

#include <quintet/quintet.h>

int main(int argc, char** argv) try {
  if (argc != 3) return std::fprintf(stderr, "usage: first_ray PROGRAM SCENE\n"), 2;
  quintet::Device device;
  const auto program = quintet::Program::load(argv[1]);
  const auto scene = quintet::Scene::load(argv[2]);
  quintet::Renderer renderer(device, scene, program, {.width = 320, .height = 240});
  renderer.render(1);
  renderer.picture().write("first_ray.png");
  std::printf("first_ray.png, rendered on %s\n", device.name().c_str());
} catch (const std::exception& error) {
  return std::fprintf(stderr, "first_ray: %s\n", error.what()), 1;
}
