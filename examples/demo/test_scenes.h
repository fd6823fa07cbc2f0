// SPDX-License-Identifier: Apache-2.0
// Small scenes with known contents for image tests, analytic tests and the benchmark. Each has one camera, "main".
// Surfaces with analytic results are Lambert reflectors without specular reflection (specular factor 0).
#ifndef QUINTET_DEMO_TEST_SCENES_H
#define QUINTET_DEMO_TEST_SCENES_H

#include <cstddef>
#include <span>
#include <vector>

#include "demo/sky.h"

namespace quintet::demo {

// plane_light.glb: a square light facing down, centered above the origin of the plane y = 0.
inline constexpr float kPlaneLightSide = 1.0f, kPlaneLightHeight = 1.0f, kPlaneLightRadiance = 5.0f;
inline constexpr float kPlaneAlbedo = 0.5f;

// furnace.glb: a Lambert sphere of radius 1 centered at the origin.
inline constexpr float kFurnaceAlbedo = 0.8f;

std::vector<std::byte> cornell();  // closed box, colored walls, light in the ceiling, a diffuse and a metal block
std::vector<std::byte> glass();    // rough glass sphere and clear slab on a plane, three light panels
std::vector<std::byte> furnace();
std::vector<std::byte> manyLights();  // 400 emissive triangles of very different power, terrain, alpha-masked leaves
std::vector<std::byte> bench();       // about 100 k triangles of terrain, 60 instances of three rocks
std::vector<std::byte> planeLight();

// Scenes that are difficult to sample (hard_scenes.cpp). The last three are for testSky().
inline constexpr std::size_t kLanterns = 10'000;
std::vector<std::byte> lanterns();  // 10,000 emissive triangles of very different power between low walls
std::vector<std::byte> panes();     // thin panes, clear, tinted and frosted, and solids of glass under light panels
std::vector<std::byte> window();    // a room with one opening
std::vector<std::byte> foliage();   // alpha-masked leaves on stems over hilly ground
std::vector<std::byte> thicket();   // about 100 k triangles of leaves, stems and ground, without alpha and instances

SkySettings testSky();  // clear; a low sun of radius 1.5 degrees shines into `window`

struct TestScene {
  const char* name;  // file name without ".glb"
  std::vector<std::byte> (*make)();
};
std::span<const TestScene> testScenes();

}  // namespace quintet::demo
#endif
