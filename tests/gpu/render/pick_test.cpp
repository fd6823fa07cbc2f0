// SPDX-License-Identifier: Apache-2.0
// The program `pick` in scenes with several kinds of geometry. Sessions compare its other values (session_test.cpp).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "../program/lecture_run.h"
#include "harness.h"

namespace quintet::test {
namespace {

// The outputs of the program in an image of 2 by 2 pixels.
struct Picks {
  io::Image colors;
  std::vector<vec4> hits, positions, normals;  // normals: with the material
};

Picks pick(const SceneBuilder& scene) {
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.program = program::loadProgram("pick");
  options.width = options.height = 2;
  render::Renderer renderer = makeRenderer(device, options.program, settingsFor(scene.scene.cameras[0], options));
  renderer.renderBatch(1);
  const render::Film& film = renderer.film();
  return {film.download(0), film.plane(1).values, film.plane(2).values, film.plane(3).values};
}

// The boxes are the first geometry of the scene, and the mesh behind them has two: each hit has the normal and the material of
// its own geometry, which is custom for the boxes only.
TEST(PickProgram, ReadsTheGeometryOfTheHit) {
  SceneBuilder scene;
  addBoxes(scene.scene, std::vector<Bounds3>{{vec3(-1, -9, -9), vec3(1, -8, 9)}});
  const vec3 edge(1, 0, 0.5f), up(0, 2, 0);
  scene.add(quad({-1, -0.8f, 0}, {1, 0, 0}, up), lambert(vec3(0.5f)));
  scene::Geometry second = quad({0, -0.8f, 0}, edge, up);
  second.material = static_cast<int>(scene.scene.materials.size());
  scene.scene.materials.push_back(lambert(vec3(0.25f)));
  scene.scene.meshes.back().geometries.push_back(second);
  scene.camera(orthographic({0, 0, 5}, {0, 0, 0}, 1.0f));
  const auto [colors, hits, positions, normals] = pick(scene);
  ASSERT_EQ(hits.size(), 4u);
  for (std::uint32_t i = 0; i < 2; ++i) {  // in the upper row
    EXPECT_EQ(hits[i].x, 2.0f) << "the second instance";
    EXPECT_EQ(hits[i].y, static_cast<float>(i)) << "geometry of the mesh";
    EXPECT_EQ(normals[i].w, static_cast<float>(i)) << "material";
    const vec3 normal = i == 0 ? vec3(0, 0, 1) : glm::normalize(glm::cross(edge, up));
    EXPECT_LT(glm::length(vec3(normals[i]) - normal), 1e-5f) << i;
    EXPECT_NEAR(positions[i].z, i == 0 ? 0.0f : 0.25f, 1e-5f) << i;
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(colors.pixel<float>(i, 0)[c], 0.5f + 0.5f * normal[c], 1e-5f) << "shows the normal";
  }
}

TEST(PickProgram, AMissIsBlackAndNoInstance) {
  SceneBuilder scene;
  scene.add(quad({-1, -9, 0}, {1, 0, 0}, {0, 1, 0}), lambert(vec3(0.5f)));
  scene.camera(orthographic({0, 0, 5}, {0, 0, 0}, 1.0f));
  const Picks picks = pick(scene);
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_THAT(picks.colors.pixel<float>(i % 2, i / 2), testing::ElementsAre(0, 0, 0, 1)) << i;
    EXPECT_EQ(picks.hits.at(i), vec4(0)) << i;
  }
}

}  // namespace
}  // namespace quintet::test
