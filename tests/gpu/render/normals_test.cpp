// SPDX-License-Identifier: Apache-2.0
// The program `normals`: shading normals, and with `geometric` those of the triangles, on the side of the camera.
#include <gtest/gtest.h>

#include "rendered_image.h"

namespace quintet::test {
namespace {

TEST(NormalsProgram, ShowsShadingAndGeometricNormals) {
  const vec3 tilted = glm::normalize(vec3(0.3f, -0.2f, 1.0f));
  scene::Geometry square = quad(vec3(-5, -5, 0), vec3(10, 0, 0), vec3(0, 10, 0));
  square.normals.assign(square.positions.size(), tilted);
  for (const float side : {1.0f, -1.0f}) {
    SceneBuilder scene;
    scene.add(square, unlit(vec3(1.0f))).camera(perspective(vec3(0.1f, 0.2f, 3.0f * side), vec3(0), 30.0f));
    ImageOptions options;
    options.program = program::loadProgram("normals");
    options.batches = 2;
    for (const bool geometric : {false, true}) {
      options.set = {geometric ? "geometric=true" : "geometric=false"};
      const vec3 normal = side * (geometric ? vec3(0, 0, 1) : tilted);
      expectUniform(renderImage(scene, options), vec4(0.5f + 0.5f * normal, 1.0f));
    }
  }
}

TEST(NormalsProgram, HasABlackBackground) {
  SceneBuilder scene;
  scene.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), unlit(vec3(1.0f)))
      .camera(orthographic(vec3(9, 0, 3), vec3(9, 0, 0), 0.05f));
  ImageOptions options;
  options.program = program::loadProgram("normals");
  options.batches = 2;
  for (const bool transparent : {false, true}) {
    options.transparent = transparent;
    expectUniform(renderImage(scene, options), vec4(0, 0, 0, transparent ? 0 : 1));
  }
}

}  // namespace
}  // namespace quintet::test
