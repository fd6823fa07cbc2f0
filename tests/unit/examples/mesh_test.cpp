// SPDX-License-Identifier: Apache-2.0
// Shapes: solids are closed with the front outside; normals and tangents are correct.
#include "demo/mesh_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace quintet::demo {
namespace {

struct Solid {
  std::string name;
  TriangleMesh mesh;
  double volume;     // expected, m³
  double tolerance;  // relative, for the tessellation
};

std::vector<Solid> solids() {
  const std::array cup = {vec2(0, 0), vec2(0.5f, 0), vec2(0.5f, 1), vec2(0.4f, 1), vec2(0.4f, 0.1f), vec2(0, 0.1f)};
  const std::array line = {vec3(0, 0, 0), vec3(0, 0.5f, 0), vec3(0, 1, 0)};
  const PrismShape straight{
      .sides = 4, .radius = 0.5f, .rounding = 0.01f, .bevel = 0.002f, .height = 1.0f, .twist = 0.0f};
  PrismShape twisted = straight;
  twisted.twist = 1.2f;
  const double pi = glm::pi<double>();
  return {
      {"icosphere", icosphere(1.0f, 5), 4.0 / 3.0 * pi, 0.003},
      {"facets", icosphere(1.0f, 0, true), 2.5361507, 1e-5},  // the icosahedron of circumradius 1
      {"cup", revolve(cup, 256), pi * (0.25 - 0.16 * 0.9), 0.001},
      {"disc", revolve(discProfile(1.0f, 0.1f, 0.01f, 8), 256), pi * 0.1, 0.005},
      {"sphere as superellipsoid", superellipsoid(vec3(1.0f), 2.0f, 64), 4.0 / 3.0 * pi, 0.003},
      {"box as superellipsoid", superellipsoid({0.5f, 1.0f, 2.0f}, 60.0f, 64), 8.0, 0.05},
      {"knot", torusKnot(2, 3, 1.0f, 0.4f, 0.1f, 480, 48), 0.0, 0.0},
      {"prism", twistedPrism(straight), 0.5, 0.005},
      {"twisted prism", twistedPrism(twisted), 0.5, 0.01},
      {"box", box({-1, 0, 2}, {1, 3, 2.5f}), 3.0, 1e-5},
      {"tube", tube(line, 0.1f, 0.1f, 128), pi * 0.01, 0.001},
  };
}

TEST(Mesh, SolidsAreClosedAndFaceOutwards) {
  for (const Solid& solid : solids()) {
    SCOPED_TRACE(solid.name);
    EXPECT_TRUE(isClosed(solid.mesh));
    EXPECT_GT(volume(solid.mesh), 0.0);
    if (solid.volume > 0.0) {
      EXPECT_NEAR(volume(solid.mesh), solid.volume, solid.tolerance * solid.volume);
    }
  }
}

TEST(Mesh, VolumeOfAKnotMatchesPappus) {
  // Pappus' theorem for a smooth closed curve: cross section times length of the center line.
  const TriangleMesh knot = torusKnot(2, 3, 1.0f, 0.4f, 0.1f, 960, 64);
  double length = 0.0;
  constexpr int kSteps = 10000;
  const auto point = [](int i) {
    const double phi = 2.0 * glm::pi<double>() * i / kSteps, r = 1.0 + 0.4 * std::cos(3 * phi);
    return glm::dvec3(r * std::cos(2 * phi), r * std::sin(2 * phi), -0.4 * std::sin(3 * phi));
  };
  for (int i = 0; i < kSteps; ++i) length += glm::distance(point(i), point(i + 1));
  EXPECT_NEAR(volume(knot), glm::pi<double>() * 0.01 * length, 0.01 * volume(knot));
}

TEST(Mesh, NormalsAreUnitAndFaceOutwards) {
  for (const Solid& solid : solids()) {
    SCOPED_TRACE(solid.name);
    const TriangleMesh& mesh = solid.mesh;
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (const vec3& n : mesh.normals) ASSERT_NEAR(glm::length(n), 1.0f, 1e-5f);
    for (const uvec3& t : mesh.triangles) {
      const vec3 face =
          glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
      for (unsigned k = 0; k < 3; ++k) ASSERT_GT(glm::dot(face, mesh.normals[t[k]]), 0.0f);
    }
  }
}

TEST(Mesh, CreasesSplitOnlySharpEdges) {
  TriangleMesh cube = box(vec3(0), vec3(1));
  computeNormals(cube, 30.0f);
  EXPECT_EQ(cube.positions.size(), 24u);
  for (const vec3& n : cube.normals) EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1.0f, 1e-6f);
  computeNormals(cube, 180.0f);
  for (std::size_t i = 0; i < cube.normals.size(); ++i) {
    EXPECT_NEAR(glm::distance(cube.normals[i], glm::normalize(cube.positions[i] - 0.5f)), 0.0f, 1e-5f);
  }
}

TEST(Mesh, OpenAndFlippedMeshesAreNotClosed) {
  TriangleMesh mesh = icosphere(1.0f, 1);
  mesh.triangles.pop_back();
  EXPECT_FALSE(isClosed(mesh));
  mesh = icosphere(1.0f, 1);
  std::swap(mesh.triangles[5].x, mesh.triangles[5].y);
  EXPECT_FALSE(isClosed(mesh));
}

TEST(Mesh, MirroringReversesTheWinding) {
  TriangleMesh mesh = icosphere(1.0f, 2);
  mesh.transform(glm::scale(mat4(1.0f), vec3(-2, 1, 1)));
  EXPECT_TRUE(isClosed(mesh));
  EXPECT_GT(volume(mesh), 0.0);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) EXPECT_GT(glm::dot(mesh.positions[i], mesh.normals[i]), 0.0f);
}

TEST(Mesh, TangentsFollowUWithTheHandednessOfGltf) {
  // An image on the floor, seen from above with -z up: u to the right, v down, not mirrored.
  TriangleMesh floor = flatDisc(0.0f, 1.0f, 16, 0.5f);
  computeTangents(floor);
  for (const vec4& t : floor.tangents) {
    EXPECT_NEAR(glm::distance(vec3(t), vec3(1, 0, 0)), 0.0f, 1e-5f);
    EXPECT_EQ(t.w, 1.0f);
  }
  for (vec2& uv : floor.uvs) uv.x = -uv.x;
  computeTangents(floor);
  for (const vec4& t : floor.tangents) {
    EXPECT_NEAR(glm::distance(vec3(t), vec3(-1, 0, 0)), 0.0f, 1e-5f);
    EXPECT_EQ(t.w, -1.0f);
  }
}

TEST(Mesh, CurvesPassThroughTheirPoints) {
  const std::array points = {vec2(0, 0), vec2(1, 2), vec2(3, 1), vec2(4, 4)};
  const std::vector<vec2> curve = smoothCurve(points, 5);
  ASSERT_EQ(curve.size(), 16u);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(curve[5 * i], points[i]);
}

}  // namespace
}  // namespace quintet::demo
