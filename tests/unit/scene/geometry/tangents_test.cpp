// SPDX-License-Identifier: Apache-2.0
// Generated tangent frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "scene/geometry/tangents.h"
#include "scene/gltf_builder.h"

namespace quintet::test {
namespace {

using scene::Geometry;
using scene::TextureUse;
using testing::Each;
using testing::IsEmpty;

// A unit square in the xy plane, facing +z. Texture coordinates as in glTF: u to the right, v downwards.
Geometry square() {
  Geometry g;
  g.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  g.normals.assign(4, vec3(0, 0, 1));
  g.uvs[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  g.triangles = {{0, 1, 2}, {0, 2, 3}};
  return g;
}

vec3 bitangent(const Geometry& g, std::size_t i) {
  return g.tangents[i].w * glm::cross(g.normals[i], vec3(g.tangents[i]));
}

MATCHER_P(IsNear4, expected, "") { return glm::distance(arg, expected) < 1e-6f; }

TEST(Tangents, FollowsUAndNegativeV) {
  Geometry g = square();
  scene::generateTangents(g, TextureUse{});
  EXPECT_EQ(g.positions.size(), 4u);
  EXPECT_THAT(g.tangents, Each(IsNear4(vec4(1, 0, 0, 1))));
  EXPECT_LT(glm::distance(bitangent(g, 0), vec3(0, 1, 0)), 1e-6f);  // up in the image
}

TEST(Tangents, FlipsTheHandednessOfMirroredMappings) {
  Geometry g = square();
  for (vec2& uv : g.uvs[0]) uv.x = 1 - uv.x;
  scene::generateTangents(g, TextureUse{});
  EXPECT_THAT(g.tangents, Each(IsNear4(vec4(-1, 0, 0, -1))));
  EXPECT_LT(glm::distance(bitangent(g, 0), vec3(0, 1, 0)), 1e-6f);
}

TEST(Tangents, FollowsTheTextureTransform) {
  Geometry g = square();
  TextureUse use;
  use.rotation = kPi / 2;  // u' = v, v' = -u
  scene::generateTangents(g, use);
  EXPECT_THAT(g.tangents, Each(IsNear4(vec4(0, -1, 0, 1))));
  EXPECT_LT(glm::distance(scene::transformUv(use, vec2(1, 0)), vec2(0, -1)), 1e-6f);
}

// The direction of the rotation in TextureTransformTest of Khronos: the arrow at (0.7778, 0.7778) in the image must
// appear at the texture coordinates of the green marker.
TEST(Tangents, RotatesTextureCoordinatesAsTheKhronosTest) {
  TextureUse use;
  use.rotation = kPi / 8;
  EXPECT_LT(glm::distance(scene::transformUv(use, vec2(0.42095f, 1.01627f)), vec2(0.77782f)), 1e-4f);
}

TEST(Tangents, UsesTheTextureCoordinateSetOfTheTexture) {
  Geometry g = square();
  g.uvs[1] = {{1, 1}, {1, 0}, {0, 0}, {0, 1}};  // rotated by 90°
  TextureUse use;
  use.uvSet = 1;
  scene::generateTangents(g, use);
  EXPECT_THAT(g.tangents, Each(IsNear4(vec4(0, -1, 0, 1))));
}

// Two adjacent squares whose mapping is mirrored at the common edge, as on a symmetric model.
TEST(Tangents, SplitsVerticesOfMirrorSeams) {
  Geometry g;
  g.positions = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
  g.normals.assign(6, vec3(0, 0, 1));
  g.uvs[0] = {{1, 1}, {0, 1}, {1, 1}, {1, 0}, {0, 0}, {1, 0}};
  g.colors.assign(6, vec4(0.5f));
  g.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  scene::generateTangents(g, TextureUse{});
  ASSERT_EQ(g.positions.size(), 8u);
  EXPECT_EQ(g.normals.size(), 8u);
  EXPECT_EQ(g.colors.size(), 8u);
  EXPECT_EQ(g.uvs[0].size(), 8u);
  EXPECT_EQ(g.tangents.size(), 8u);
  for (std::size_t t = 0; t < 4; ++t) {
    const vec4 expected = t < 2 ? vec4(-1, 0, 0, -1) : vec4(1, 0, 0, 1);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_THAT(g.tangents[g.triangles[t][c]], IsNear4(expected)) << t << " " << c;
  }
  for (const uvec3& t : g.triangles)
    for (std::size_t c = 0; c < 3; ++c) EXPECT_LT(glm::distance(bitangent(g, t[c]), vec3(0, 1, 0)), 1e-6f);
}

// --- MikkTSpace ------------------------------------------------------------------------------------------------------

// A curved surface of n x n cells with mirrored, rotated and stretched texture coordinates. `split`: each triangle has its
// own vertices.
Geometry curved(unsigned n, bool split) {
  Geometry g;
  for (unsigned y = 0; y <= n; ++y)
    for (unsigned x = 0; x <= n; ++x) {
      const vec2 p = vec2(x, y) / static_cast<float>(n);
      g.positions.emplace_back(p, std::sin(3.0f * p.x) * std::cos(2.0f * p.y));
      g.normals.push_back(glm::normalize(vec3(-3.0f * std::cos(3.0f * p.x) * std::cos(2.0f * p.y),
                                              2.0f * std::sin(3.0f * p.x) * std::sin(2.0f * p.y), 1.0f)));
      g.uvs[0].emplace_back(std::abs(p.x - 0.5f) + 0.3f * p.y, p.y * p.y - 0.2f * p.x);
    }
  for (unsigned y = 0; y < n; ++y)
    for (unsigned x = 0; x < n; ++x) {
      const unsigned a = y * (n + 1) + x, b = a + n + 1;
      g.triangles.insert(g.triangles.end(), {{a, a + 1, b + 1}, {a, b + 1, b}});
    }
  if (!split) return g;
  Geometry apart;
  for (const uvec3& t : g.triangles) {
    const auto first = static_cast<unsigned>(apart.positions.size());
    for (std::size_t c = 0; c < 3; ++c) {
      apart.positions.push_back(g.positions[t[c]]);
      apart.normals.push_back(g.normals[t[c]]);
      apart.uvs[0].push_back(g.uvs[0][t[c]]);
    }
    apart.triangles.emplace_back(first, first + 1, first + 2);
  }
  return apart;
}

// The tangents of all corners.
std::vector<vec4> cornerTangents(Geometry g) {
  scene::generateTangents(g, TextureUse{});
  std::vector<vec4> result;
  for (const uvec3& t : g.triangles)
    for (std::size_t c = 0; c < 3; ++c) result.push_back(g.tangents[t[c]]);
  return result;
}

// The definition, without any structure: for each corner, its group by repeated search over all triangles.
std::vector<vec4> naiveTangents(const Geometry& g) {
  using glm::dvec3;
  const auto same = [&](unsigned a, unsigned b) {
    return g.positions[a] == g.positions[b] && g.normals[a] == g.normals[b] && g.uvs[0][a] == g.uvs[0][b];
  };
  const auto inPlane = [](const dvec3& v, const dvec3& n) { return glm::normalize(v - n * glm::dot(n, v)); };
  const std::size_t count = g.triangles.size();
  std::vector<dvec3> tangent(count);
  std::vector<double> area(count);
  for (std::size_t i = 0; i < count; ++i) {
    const uvec3& t = g.triangles[i];
    const glm::dvec2 a = g.uvs[0][t.y] - g.uvs[0][t.x], b = g.uvs[0][t.z] - g.uvs[0][t.x];
    area[i] = a.x * b.y - a.y * b.x;
    // Solve e1 = a.x T + a.y B, e2 = b.x T + b.y B for T.
    tangent[i] =
        (b.y * dvec3(g.positions[t.y] - g.positions[t.x]) - a.y * dvec3(g.positions[t.z] - g.positions[t.x])) / area[i];
  }
  std::vector<vec4> result;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const unsigned vertex = g.triangles[i][c];
      const dvec3 n = g.normals[vertex];
      std::vector<std::pair<std::size_t, std::size_t>> group{{i, c}};
      for (std::size_t k = 0; k < group.size(); ++k) {
        const auto [from, corner] = group[k];
        for (std::size_t j = 0; j < count; ++j)
          for (std::size_t d = 0; d < 3; ++d) {
            if (!same(g.triangles[j][d], vertex) || area[j] * area[i] <= 0.0) continue;
            const bool next = same(g.triangles[from][(corner + 1) % 3], g.triangles[j][(d + 2) % 3]);
            const bool previous = same(g.triangles[from][(corner + 2) % 3], g.triangles[j][(d + 1) % 3]);
            const std::pair found(j, d);
            if ((next || previous) && std::ranges::find(group, found) == group.end()) group.push_back(found);
          }
      }
      dvec3 sum(0.0);
      for (const auto& [j, d] : group) {
        const dvec3 p = g.positions[g.triangles[j][d]];
        const dvec3 a = inPlane(dvec3(g.positions[g.triangles[j][(d + 1) % 3]]) - p, n);
        const dvec3 b = inPlane(dvec3(g.positions[g.triangles[j][(d + 2) % 3]]) - p, n);
        sum += std::acos(glm::dot(a, b)) * inPlane(tangent[j], n);
      }
      result.emplace_back(vec3(inPlane(sum, n)), area[i] > 0.0 ? -1.0f : 1.0f);
    }
  }
  return result;
}

TEST(Tangents, AgreeWithTheDefinition) {
  const Geometry g = curved(6, false);
  const std::vector<vec4> tangents = cornerTangents(g), exact = naiveTangents(g);
  for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_LT(glm::distance(tangents[i], exact[i]), 1e-5f) << i;
  EXPECT_THAT(exact, testing::Contains(testing::ResultOf([](const vec4& t) { return t.w; }, 1.0f)));
  EXPECT_THAT(exact, testing::Contains(testing::ResultOf([](const vec4& t) { return t.w; }, -1.0f)));
}

TEST(Tangents, DoNotDependOnSharedVertices) {
  EXPECT_EQ(cornerTangents(curved(9, false)), cornerTangents(curved(9, true)));
}

TEST(Tangents, DoNotDependOnTheOrderOfTriangles) {
  const Geometry g = curved(9, false);
  const std::vector<vec4> tangents = cornerTangents(g);
  std::vector<std::size_t> order(g.triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937 random(5);
  for (int round = 0; round < 3; ++round) {
    std::shuffle(order.begin(), order.end(), random);
    Geometry shuffled = g;
    for (std::size_t i = 0; i < order.size(); ++i) shuffled.triangles[i] = g.triangles[order[i]];
    const std::vector<vec4> result = cornerTangents(shuffled);
    for (std::size_t i = 0; i < result.size(); ++i) EXPECT_EQ(result[i], tangents[3 * order[i / 3] + i % 3]);
  }
}

// Two triangles that meet only in one point do not share their tangents there.
TEST(Tangents, SplitTrianglesThatShareNoEdge) {
  Geometry g;
  g.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  g.normals.assign(5, vec3(0, 0, 1));
  g.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, -1}, {1, -1}};  // the second one is turned by 90°
  g.triangles = {{0, 1, 2}, {0, 3, 4}};
  const std::vector<vec4> tangents = cornerTangents(g);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_THAT(tangents[c], IsNear4(vec4(1, 0, 0, -1)));
    EXPECT_THAT(tangents[3 + c], IsNear4(vec4(0, -1, 0, -1)));
  }
}

// A triangle without area in the texture takes the tangent of its neighbors and joins them. One without area in space
// changes nothing.
TEST(Tangents, GiveDegenerateTrianglesThoseOfTheirNeighbors) {
  Geometry g = square();
  g.positions.insert(g.positions.end(), {{2, 0, 0}, {2, 1, 0}});
  g.normals.resize(6, vec3(0, 0, 1));
  g.uvs[0].insert(g.uvs[0].end(), {{1, 1}, {1, 0}});  // no area between x = 1 and x = 2
  g.triangles.insert(g.triangles.end(), {{1, 4, 5}, {1, 5, 2}, {0, 0, 2}});
  Geometry whole = g;
  scene::generateTangents(whole, TextureUse{});
  EXPECT_EQ(whole.positions.size(), 6u);
  const std::vector<vec4> tangents = cornerTangents(g);
  for (const std::size_t corner : {0u, 1u, 2u, 3u, 4u, 5u, 6u, 9u, 11u, 12u, 13u, 14u})
    EXPECT_THAT(tangents[corner], IsNear4(vec4(1, 0, 0, 1))) << corner;
}

// Many triangles around one vertex that share no edges take linear time.
TEST(Tangents, AcceptManyTrianglesAroundOneVertex) {
  Geometry g;
  constexpr unsigned kCount = 100000;
  g.positions.emplace_back(0.0f);
  g.uvs[0].emplace_back(0.0f);
  for (unsigned i = 0; i < kCount; ++i) {
    const float angle = 6.28f * static_cast<float>(i) / kCount;
    for (const float a : {angle, angle + 2e-5f}) {
      g.positions.emplace_back(std::cos(a), std::sin(a), 0);
      g.uvs[0].emplace_back(std::cos(a), std::sin(a));
    }
    g.triangles.emplace_back(0, 2 * i + 1, 2 * i + 2);
  }
  g.normals.assign(g.positions.size(), vec3(0, 0, 1));
  scene::generateTangents(g, TextureUse{});
  EXPECT_EQ(g.positions.size(), 3u * kCount);
}

TEST(Tangents, ReturnsUnitVectorsForDegenerateMappings) {
  Geometry g = square();
  for (vec2& uv : g.uvs[0]) uv = vec2(0.5f);
  scene::generateTangents(g, TextureUse{});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(glm::length(vec3(g.tangents[i])), 1.0f, 1e-6f);
    EXPECT_NEAR(glm::dot(vec3(g.tangents[i]), g.normals[i]), 0.0f, 1e-6f);
    EXPECT_EQ(std::abs(g.tangents[i].w), 1.0f);
  }
}

TEST(Tangents, DoesNothingWithoutNormalsOrTextureCoordinates) {
  Geometry g = square();
  g.normals.clear();
  scene::generateTangents(g, TextureUse{});
  EXPECT_THAT(g.tangents, IsEmpty());
  g = square();
  g.uvs[0].clear();
  scene::generateTangents(g, TextureUse{});
  EXPECT_THAT(g.tangents, IsEmpty());
}

TEST(Tangents, GivesFlatTrianglesTheirOwnVertices) {
  Geometry g = square();
  g.normals.clear();
  g.positions[3].z = 1;
  scene::splitIntoFlatTriangles(g);
  ASSERT_EQ(g.positions.size(), 6u);
  EXPECT_EQ(g.triangles[1], uvec3(3, 4, 5));
  EXPECT_EQ(g.normals[0], vec3(0, 0, 1));
  EXPECT_EQ(g.normals[3], g.normals[5]);
  EXPECT_NE(g.normals[3], g.normals[0]);
  EXPECT_EQ(g.uvs[0][5], vec2(0, 0));
}

// The order is that of tangents.h. Each of the textures has a different frame.
TEST(Tangents, FollowTheFirstTextureThatNeedsThem) {
  Geometry plain = square();
  plain.uvs[1] = {{1, 1}, {1, 0}, {0, 0}, {0, 1}};  // rotated by 90°
  scene::Material material;
  EXPECT_FALSE(scene::addTangents(plain, material));
  const auto expectTangent = [&](const vec4& tangent) {
    Geometry g = plain;
    EXPECT_TRUE(scene::addTangents(g, material));
    EXPECT_THAT(g.tangents, testing::AllOf(testing::SizeIs(4), Each(IsNear4(tangent))));
  };
  material.anisotropy = 0.5f;
  expectTangent(vec4(1, 0, 0, 1));  // of the first texture coordinates
  material.anisotropyTexture.texture = 0;
  material.anisotropyTexture.rotation = kPi;
  expectTangent(vec4(-1, 0, 0, 1));
  material.clearcoatNormalTexture.texture = 0;
  material.clearcoatNormalTexture.uvSet = 1;
  expectTangent(vec4(0, -1, 0, 1));
  material.normalTexture.texture = 0;
  expectTangent(vec4(1, 0, 0, 1));
}

// The importer generates tangents only for normal maps and anisotropy, also for flat shading.
TEST(Tangents, GeneratesTangentsForNormalMaps) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.primitive()["attributes"]["TEXCOORD_0"] = builder.addAccessor<float>({0, 1, 1, 1, 0, 0}, "VEC2");
  builder.primitive()["material"] = 0;
  builder.add("images", {{"bufferView", builder.addView(tinyPng())}});
  builder.add("textures", {{"source", 0}});
  builder.add("materials", Json::object());
  EXPECT_THAT(builder.load().meshes[0].geometries[0].tangents, IsEmpty());
  for (const Json& material :
       {Json{{"normalTexture", {{"index", 0}}}},
        Json{{"extensions", {{"KHR_materials_clearcoat", {{"clearcoatNormalTexture", {{"index", 0}}}}}}}},
        Json{{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}}}}}}}) {
    builder.root["materials"][0] = material;
    const Geometry g = builder.load().meshes[0].geometries[0];
    EXPECT_THAT(g.normals, Each(vec3(0, 0, 1)));
    EXPECT_THAT(g.tangents, testing::SizeIs(3));
    EXPECT_THAT(g.tangents, Each(IsNear4(vec4(1, 0, 0, 1))));
  }
}

}  // namespace
}  // namespace quintet::test
