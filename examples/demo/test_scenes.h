// Small scenes with known contents for the image tests, the analytic tests and the benchmark. Each has one
// camera, "main". Surfaces that tests compute by hand are pure Lambert reflectors (specular factor 0).
#ifndef QUINTET_DEMO_TEST_SCENES_H
#define QUINTET_DEMO_TEST_SCENES_H

#include <cstddef>
#include <span>
#include <vector>

#include "demo/sky.h"

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

// hard_scenes.cpp: what is hard to sample. The last two are meant for testSky().
inline constexpr std::size_t kLanterns = 10'000;
std::vector<std::byte> lanterns();  // 10,000 emissive triangles of very different power between low walls
std::vector<std::byte> panes();     // thin panes, clear, tinted and frosted, and solids of glass under light panels
std::vector<std::byte> window();    // a room with one opening
std::vector<std::byte> foliage();   // alpha-masked leaves on stems over hilly ground

SkySettings testSky();  // clear, with a low sun of 1.5 degrees that shines into `window`

struct TestScene {
  const char* name;  // of the file, without ".glb"
  std::vector<std::byte> (*make)();
};
std::span<const TestScene> testScenes();

}  // namespace quintet::demo
#endif
