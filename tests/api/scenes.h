// SPDX-License-Identifier: Apache-2.0
// Scenes, and one device for all tests of the process.
#ifndef QUINTET_TESTS_API_SCENES_H
#define QUINTET_TESTS_API_SCENES_H

#include <quintet/quintet.h>

#include <array>
#include <string>
#include <vector>

namespace quintet::test {

inline Device& device() {
  static Device shared;
  return shared;
}

// Vertices of a square in the xz plane, facing +y.
inline constexpr std::array<Float3, 4> kCorners{{{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}}};
inline constexpr std::array<UInt3, 2> kSquare{{{0, 1, 2}, {0, 2, 3}}};

inline int addSquare(Scene& scene, const Material& material) {
  return scene.addMesh({.positions = kCorners, .indices = kSquare, .material = scene.addMaterial(material)},
                       material.name);
}

// A floor (instance and material 0) below a lamp (1), with a small panel (2) between them.
inline Scene lampScene() {
  Scene scene;
  const int floor = addSquare(scene, {.name = "floor", .baseColor = {0.7f, 0.6f, 0.5f, 1}});
  const int lamp = addSquare(scene, {.name = "lamp", .emissive = {8, 7, 6}, .doubleSided = true});
  const int panel = addSquare(scene, {.name = "panel", .baseColor = {0.2f, 0.5f, 0.3f, 1}, .doubleSided = true});
  scene.addInstance({.mesh = floor, .worldFromObject = Transform::scaling({3, 1, 3}), .name = "floor"});
  scene.addInstance({.mesh = lamp,
                     .worldFromObject = Transform::translation({0, 2.5f, 0}) * Transform::scaling({0.5f, 1, 0.5f}),
                     .name = "lamp"});
  scene.addInstance({.mesh = panel,
                     .worldFromObject = Transform::translation({0.6f, 1, 0}) * Transform::scaling({0.5f, 1, 0.5f}),
                     .name = "panel"});
  return scene;
}

inline constexpr Camera kCamera{.lookFrom = {0, 2, 6}, .lookAt = {0, 0.8f, 0}};

inline Settings smallImage() { return {.width = 48, .height = 32, .camera = kCamera}; }

inline const Program& pathTracer() {
  static const Program program = Program::load("pathtracer");
  return program;
}

// A program whose samples all have this value, a GLSL expression. `declarations` come before main(), `parameters` are
// [[parameter]] tables.
inline Program constantProgram(const std::string& value, const std::string& declarations = {},
                               const std::string& parameters = {}) {
  const std::string description = R"([program]
ray_generation = "main.rgen"
[[ray]]
name = "radiance"
miss = "<quintet/stages/radiance.rmiss>"
[[hit_group]]
name = "all"
radiance = { closest_hit = "<quintet/stages/surface.rchit>" }
[[output]]
name = "color"
)";
  const std::string rayGeneration = R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/output.glsl>
#include <quintet/texture.glsl>
#include <quintet/trace.glsl>
)" + declarations + R"(
void main() {
  const HitPayload hit = traceClosest(vec3(0.0, 9.0, 0.0), vec3(0.0, -1.0, 0.0), kInfinity, 0u);
  const vec4 value = hit.t > 0.0 ? )" +
                                    value + R"( : vec4(0.0);
  const uvec2 pixel = launchPixel();
  storeOutput(kOutput_color, pixel, loadOutput(kOutput_color, pixel) + float(launch.sampleCount) * value);
}
)";
  return Program::fromFiles({{"program.toml", description + parameters}, {"main.rgen", rayGeneration}}, "constant");
}

// The message of the exception that `action` throws.
template <class Action>
std::string messageOf(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// The image of a new renderer.
inline std::vector<float> rendered(const Scene& scene, const Settings& settings = smallImage(),
                                   std::uint32_t samples = 4) {
  Renderer renderer(device(), scene, pathTracer(), settings);
  renderer.render(samples);
  return renderer.image().pixels;
}

}  // namespace quintet::test
#endif
