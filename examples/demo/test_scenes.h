// Small scenes with known contents for the image tests, the analytic tests and the benchmark. Each has one
// camera, "main". Surfaces that tests compute by hand are pure Lambert reflectors (specular factor 0).
#ifndef QUINTET_DEMO_TEST_SCENES_H
#define QUINTET_DEMO_TEST_SCENES_H

#include <cstddef>
#include <span>
#include <vector>

namespace quintet::demo {

// plane_light.glb: a square light facing down, centred over the origin of the plane y = 0.
inline constexpr float kPlaneLightSide = 1.0f, kPlaneLightHeight = 1.0f, kPlaneLightRadiance = 5.0f;
inline constexpr float kPlaneAlbedo = 0.5f;

// furnace.glb: a Lambert sphere of radius 1 around the origin.
inline constexpr float kFurnaceAlbedo = 0.8f;

std::vector<std::byte> cornell();  // closed box, coloured walls, light in the ceiling, a diffuse and a metal block
std::vector<std::byte> glass();    // rough glass sphere and clear slab on a plane, three light panels
std::vector<std::byte> furnace();
std::vector<std::byte> manyLights();  // 400 emissive triangles of very different power, terrain, alpha-masked leaves
std::vector<std::byte> bench();       // about 100 k triangles of terrain, 60 instances of three rocks
std::vector<std::byte> planeLight();

struct TestScene {
  const char* name;  // of the file, without ".glb"
  std::vector<std::byte> (*make)();
};
std::span<const TestScene> testScenes();

}  // namespace quintet::demo
#endif
