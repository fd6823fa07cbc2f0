// SPDX-License-Identifier: Apache-2.0
// What is visible at a pixel, found by a ray through the centers of pixel and lens (the program `pick`).
#ifndef QUINTET_JOB_INTERACTIVE_PICKING_H
#define QUINTET_JOB_INTERACTIVE_PICKING_H

#include <cstddef>
#include <cstdint>
#include <future>
#include <optional>

#include "job/engine.h"
#include "program/description/program.h"
#include "render/scene/device_scene.h"

namespace quintet::job::interactive {

struct Pick {
  std::size_t instance = 0;  // index in scene.instances
  std::size_t geometry = 0;  // index in the mesh
  std::uint32_t primitive = 0;
  std::size_t material = 0;  // index in scene::materialNames(): the last one is the default material
  vec3 position{0.0f};       // world space
  vec3 normal{0.0f};         // shading normal on the camera's side, world space
  vec3 geometricNormal{0.0f};
  bool front = true;   // the camera sees the front of the triangle, or is outside of the solid
  float distance = 0;  // length of the camera ray, meters
};

// `size`: of the whole image, which contains `pixel` (x right, y down). `shown`: the program for which the scene is
// prepared, so that it stays so. Nothing means that the pixel shows no surface. Boxes with a surface that only a
// program knows are picked as boxes. Blocks. Throws gpu errors.
std::optional<Pick> pick(Engine& engine, render::DeviceScene& scene, const scene::Camera& camera, uvec2 size,
                         uvec2 pixel, const program::Program& shown);

// Compiles the program of pick() in another thread, for the cache of the engine's compiler, so that the first pick()
// does not wait for it. `engine` outlives the result. Errors are those of the first pick().
std::future<void> compilePicking(Engine& engine, const render::DeviceScene& scene, const program::Program& shown);

}  // namespace quintet::job::interactive
#endif
