// SPDX-License-Identifier: Apache-2.0
// Generated tangent frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
