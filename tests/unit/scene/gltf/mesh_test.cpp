// SPDX-License-Identifier: Apache-2.0
// Primitives: modes, attributes, repairs, morph targets and skins.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/error_matcher.h"
#include "scene/gltf_builder.h"

namespace quintet::test {
namespace {

using scene::Geometry;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Five points of a zigzag: a strip, a fan, or one triangle and two remaining vertices.
struct ModeBuilder : GltfBuilder {
  explicit ModeBuilder(int mode) {
    const int positions = addAccessor<float>({0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0}, "VEC3");
    addMesh({{"attributes", {{"POSITION", positions}}}, {"mode", mode}});
  }
};

std::vector<uvec3> trianglesOf(const GltfBuilder& builder) {
  const scene::Scene scene = builder.load();
  return scene.meshes.at(0).geometries.at(0).triangles;
}

TEST(GltfMesh, ReadsTriangleModes) {
  EXPECT_THAT(trianglesOf(ModeBuilder(4)), ElementsAre(uvec3(0, 1, 2)));
  EXPECT_THAT(trianglesOf(ModeBuilder(5)), ElementsAre(uvec3(0, 1, 2), uvec3(1, 3, 2), uvec3(2, 3, 4)));
  EXPECT_THAT(trianglesOf(ModeBuilder(6)), ElementsAre(uvec3(1, 2, 0), uvec3(2, 3, 0), uvec3(3, 4, 0)));
}

TEST(GltfMesh, ReadsIndexedStripsAndFans) {
  ModeBuilder strip(5), fan(6);
  for (GltfBuilder* builder : {static_cast<GltfBuilder*>(&strip), static_cast<GltfBuilder*>(&fan)})
    builder->primitive()["indices"] = builder->addAccessor<std::uint16_t>({4, 3, 2, 1}, "SCALAR");
  EXPECT_THAT(trianglesOf(strip), ElementsAre(uvec3(4, 3, 2), uvec3(3, 1, 2)));
  EXPECT_THAT(trianglesOf(fan), ElementsAre(uvec3(3, 2, 4), uvec3(2, 1, 4)));
}

TEST(GltfMesh, ReportsModesWithoutSurface) {
  const std::pair<int, std::string> modes[] = {{0, "POINTS"}, {1, "LINES"}, {2, "LINE_LOOP"}, {3, "LINE_STRIP"}};
  for (const auto& [mode, name] : modes) {
    const scene::Scene scene = ModeBuilder(mode).load();
    EXPECT_THAT(scene.meshes, IsEmpty());
    EXPECT_THAT(scene.instances, IsEmpty());
    EXPECT_THAT(scene.report.ignored, ElementsAre(IsErrorAt("/meshes/0/primitives/0", "mode " + name)));
  }
  EXPECT_THAT(errorOf(ModeBuilder(7)), IsErrorAt("/meshes/0/primitives/0/mode", "7"));
}

TEST(GltfMesh, IgnoresPrimitivesWithoutPositionsOrTriangles) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.addMesh({{"attributes", {{"NORMAL", 0}}}});
  const int two = builder.addAccessor<float>({0, 0, 0, 1, 1, 1}, "VEC3");
  builder.addMesh({{"attributes", {{"POSITION", two}}}});
  builder.add("meshes", {{"primitives", Json::array({{{"attributes", {{"POSITION", two}}}, {"material", 4}}})}});
  EXPECT_THAT(errorOf(builder), IsErrorAt("/meshes/3/primitives/0/material", "material 4"));
  builder.root["meshes"].erase(3);
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_THAT(scene.report.ignored, ElementsAre(IsErrorAt("/meshes/1/primitives/0", "POSITION"),
                                                IsErrorAt("/meshes/2/primitives/0", "triangles")));
}

TEST(GltfMesh, RejectsDifferentAttributeCounts) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.primitive()["attributes"]["NORMAL"] = builder.addAccessor<float>({0, 0, 1, 0, 0, 1}, "VEC3");
  EXPECT_THAT(errorOf(builder), IsErrorAt("/meshes/0/primitives/0/attributes/NORMAL", "2 elements"));
}

TEST(GltfMesh, ReadsAllAttributes) {
  GltfBuilder builder;
  builder.addTriangle();
  Json& attributes = builder.primitive()["attributes"];
  attributes["NORMAL"] = builder.addAccessor<std::int8_t>({0, 0, 127, 0, 0, 64, 0, 0, 127, 0, 0, 0}, "VEC4", true);
  builder.root["accessors"][1]["type"] = "VEC3";  // three bytes with a stride of four
  builder.root["accessors"][1]["count"] = 3;
  builder.root["bufferViews"][1]["byteStride"] = 4;
  attributes["TANGENT"] = builder.addAccessor<float>({2, 0, 0, 1, 0, 1, 0, -1, 1, 0, 0, -7}, "VEC4");
  attributes["TEXCOORD_0"] = builder.addAccessor<std::uint16_t>({0, 0, 65535, 0, 0, 65535}, "VEC2", true);
  attributes["TEXCOORD_1"] = builder.addAccessor<std::uint8_t>({0, 0, 255, 0, 0, 51}, "VEC2", true);
  attributes["TEXCOORD_2"] = attributes["TEXCOORD_1"];
  attributes["COLOR_0"] = builder.addAccessor<std::uint8_t>({255, 0, 0, 0, 51, 0, 0, 0, 255}, "VEC3", true);
  attributes["_MINE"] = 0;
  const scene::Scene scene = builder.load();
  const Geometry& geometry = scene.meshes[0].geometries[0];
  EXPECT_THAT(geometry.normals, ElementsAre(vec3(0, 0, 1), vec3(0, 1, 0), vec3(1, 0, 0)));
  EXPECT_THAT(geometry.tangents, ElementsAre(vec4(1, 0, 0, 1), vec4(0, 1, 0, -1), vec4(1, 0, 0, -1)));
  EXPECT_THAT(geometry.uvs[0], ElementsAre(vec2(0, 0), vec2(1, 0), vec2(0, 1)));
  EXPECT_THAT(geometry.uvs[1], ElementsAre(vec2(0, 0), vec2(1, 0), vec2(0, 0.2f)));
  EXPECT_THAT(geometry.colors, ElementsAre(vec4(1, 0, 0, 1), vec4(0, 0.2f, 0, 1), vec4(0, 0, 1, 1)));
  EXPECT_THAT(scene.report.ignored, ElementsAre(IsErrorAt("/meshes/0/primitives/0/attributes/TEXCOORD_2", "")));
}

TEST(GltfMesh, ReadsColorsWithAlpha) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.primitive()["attributes"]["COLOR_0"] =
      builder.addAccessor<float>({1, 2, 3, 0.5f, kNan, 0, 0, 1, -1, 0.25f, 0, 1}, "VEC4");
  const scene::Scene scene = builder.load();
  EXPECT_THAT(scene.meshes[0].geometries[0].colors, ElementsAre(vec4(1, 2, 3, 0.5f), vec4(1), vec4(0, 0.25f, 0, 1)));
  EXPECT_THAT(scene.report.repaired, ElementsAre(IsErrorAt("/meshes/0/primitives/0", "1 non-finite")));
}

TEST(GltfMesh, DropsTangentsWithoutNormals) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.primitive()["attributes"]["TANGENT"] =
      builder.addAccessor<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4");
  EXPECT_THAT(builder.load().meshes[0].geometries[0].tangents, IsEmpty());
}

TEST(GltfMesh, DropsTrianglesWithNonFiniteVertices) {
  GltfBuilder builder;
  const float inf = std::numeric_limits<float>::infinity();
  const int positions = builder.addAccessor<float>({kNan, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5, 0, -inf, 0}, "VEC3");
  const int indices = builder.addAccessor<std::uint8_t>({0, 1, 2, 1, 2, 3, 1, 3, 4, 3, 2, 1}, "SCALAR");
  builder.addMesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  const scene::Scene scene = builder.load();
  const Geometry& geometry = scene.meshes[0].geometries[0];
  EXPECT_THAT(geometry.triangles, ElementsAre(uvec3(0, 1, 2), uvec3(2, 1, 0)));
  EXPECT_THAT(geometry.fileTriangles, ElementsAre(1u, 3u));
  EXPECT_THAT(geometry.positions, ElementsAre(vec3(1, 0, 0), vec3(0, 1, 0), vec3(5, 5, 5)));
  EXPECT_EQ(scene::worldBounds(scene).max, vec3(5));
  EXPECT_THAT(scene.report.repaired, ElementsAre(IsErrorAt("/meshes/0/primitives/0", "2 triangles")));
}

TEST(GltfMesh, KeepsDegenerateTriangles) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.primitive()["indices"] = builder.addAccessor<std::uint8_t>({0, 0, 0, 0, 1, 2}, "SCALAR");
  EXPECT_EQ(trianglesOf(builder).size(), 2u);
}

TEST(GltfMesh, ReplacesInvalidNormals) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.primitive()["attributes"]["NORMAL"] = builder.addAccessor<float>({0, 0, 0, 0, 1e-30f, 0, kNan, 0, 0}, "VEC3");
  const scene::Scene scene = builder.load();
  EXPECT_THAT(scene.meshes[0].geometries[0].normals, ElementsAre(vec3(0, 0, 1), vec3(0, 1, 0), vec3(0, 0, 1)));
  EXPECT_THAT(scene.report.repaired, ElementsAre(IsErrorAt("/meshes/0/primitives/0", "2 normals")));
}

struct MorphBuilder : GltfBuilder {
  MorphBuilder() {
    addTriangle();
    primitive()["attributes"]["NORMAL"] = addAccessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    const int up = addAccessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    const int side = addAccessor<float>({2, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3");
    const int tilt = addAccessor<float>({0, 2, -2, 0, 0, 0, 0, 0, 0}, "VEC3");
    primitive()["targets"] = {{{"POSITION", up}}, {{"POSITION", side}, {"NORMAL", tilt}}};
  }
};

TEST(GltfMorph, AppliesTheWeightsOfTheMesh) {
  MorphBuilder builder;
  EXPECT_EQ(builder.load().meshes[0].geometries[0].positions[0], vec3(0));
  builder.root["meshes"][0]["weights"] = {0.5, 0.25};
  const Geometry geometry = builder.load().meshes[0].geometries[0];
  EXPECT_THAT(geometry.positions, ElementsAre(vec3(0.5f, 0, 0.5f), vec3(1, 0, 0.5f), vec3(0, 1, 0.5f)));
  EXPECT_LT(glm::distance(geometry.normals[0], glm::normalize(vec3(0, 1, 1))), 1e-6f);
  EXPECT_EQ(geometry.normals[1], vec3(0, 0, 1));
}

TEST(GltfMorph, CreatesAMeshForTheWeightsOfANode) {
  MorphBuilder builder;
  builder.add("nodes", {{"mesh", 0}, {"weights", {1, 0}}});
  builder.add("nodes", {{"mesh", 0}, {"weights", {1, 0}}});
  const scene::Scene scene = builder.load();
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[1].geometries[0].positions[0], vec3(0, 0, 1));
  EXPECT_EQ(scene.instances[0].mesh, 0);
  EXPECT_EQ(scene.instances[1].mesh, 1);
  EXPECT_EQ(scene.instances[2].mesh, 1);
}

TEST(GltfMorph, RejectsInconsistentTargets) {
  MorphBuilder builder;
  builder.root["meshes"][0]["weights"] = {1};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/meshes/0/weights", "1 weight for 2 morph targets"));
  builder.root["meshes"][0].erase("weights");
  builder.root["nodes"][0]["weights"] = {1, 2, 3};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/nodes/0/weights", "3 weights"));
  builder.root["nodes"][0].erase("weights");
  builder.primitive()["targets"][1]["POSITION"] = builder.addAccessor<float>({1, 2, 3}, "VEC3");
  EXPECT_THAT(errorOf(builder),
              IsErrorAt("/meshes/0/primitives/0/targets/1/POSITION", "1 element, but POSITION has 3"));
  builder.primitive()["targets"][1]["POSITION"] = 77;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/meshes/0/primitives/0/targets/1/POSITION", "accessor 77"));
}

// A triangle with two joints: the first vertex uses joint 0, the second joint 1, the third both equally.
struct SkinBuilder : GltfBuilder {
  SkinBuilder() {
    addTriangle();
    Json& attributes = primitive()["attributes"];
    attributes["NORMAL"] = addAccessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    attributes["JOINTS_0"] = addAccessor<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, "VEC4");
    attributes["WEIGHTS_0"] =
        addAccessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 0.25f, 0.25f, 0, 0}, "VEC4");  // not normalized
    const int bind =
        addAccessor<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,   //
                            1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},  // joint 1 at x = 1 in the bind pose
                           "MAT4");
    add("nodes", {{"name", "arm"}, {"translation", {0, 10, 0}}, {"children", {2}}});
    add("nodes", {{"name", "hand"}, {"translation", {1, 0, 0}}, {"rotation", {0, 0, 1, 0}}});  // half a turn about z
    add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", bind}});
    root["nodes"][0]["skin"] = 0;
    root["nodes"][0]["translation"] = {100, 100, 100};  // must have no effect
  }
};

TEST(GltfSkin, JointsMoveTheVertices) {
  const scene::Scene scene = SkinBuilder().load();
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].worldFromObject, mat4(1.0f));
  const Geometry& geometry = scene.meshes[0].geometries[0];
  EXPECT_LT(glm::distance(geometry.positions[0], vec3(0, 10, 0)), 1e-5f);
  EXPECT_LT(glm::distance(geometry.positions[1], vec3(1, 10, 0)), 1e-5f);  // at its joint, the center of the rotation
  // (0,1,0): joint 0 gives (0,11,0), joint 1 gives (1,10,0) + half turn of (-1,1,0) = (2,9,0)
  EXPECT_LT(glm::distance(geometry.positions[2], vec3(1, 10, 0)), 1e-5f);
  EXPECT_LT(glm::distance(geometry.normals[1], vec3(0, 0, 1)), 1e-5f);
}

TEST(GltfSkin, BlendsEightWeights) {
  SkinBuilder builder;
  Json& attributes = builder.primitive()["attributes"];
  // The second set outweighs the first on vertex 0: three quarters of joint 1.
  attributes["JOINTS_1"] = builder.addAccessor<std::uint16_t>({1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4");
  attributes["WEIGHTS_1"] = builder.addAccessor<float>({3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4");
  const Geometry geometry = builder.load().meshes[0].geometries[0];
  // (0,0,0): joint 0 gives (0,10,0), joint 1 gives (2,10,0)
  EXPECT_LT(glm::distance(geometry.positions[0], vec3(1.5f, 10, 0)), 1e-5f);
}

TEST(GltfSkin, RejectsInconsistentSkins) {
  const auto errorWith = [](auto change) {
    SkinBuilder builder;
    change(builder);
    return errorOf(builder);
  };
  EXPECT_THAT(errorWith([](auto& b) { b.root["skins"][0]["joints"] = {1}; }),
              IsErrorAt("/meshes/0/primitives/0/attributes/JOINTS_0", "joint 1"));
  EXPECT_THAT(errorWith([](auto& b) {
                b.root["skins"][0]["joints"] = {1, 2, 2};
              }),
              IsErrorAt("/skins/0/inverseBindMatrices", "2 matrices"));
  EXPECT_THAT(errorWith([](auto& b) {
                b.root["skins"][0]["joints"] = {1, 9};
              }),
              IsErrorAt("/skins/0/joints/1", "node 9"));
  EXPECT_THAT(errorWith([](auto& b) { b.root["skins"][0]["inverseBindMatrices"] = 0; }),
              IsErrorAt("/skins/0/inverseBindMatrices", "VEC3"));
  EXPECT_THAT(errorWith([](auto& b) { b.root["nodes"][0]["skin"] = 1; }), IsErrorAt("/nodes/0/skin", "skin 1"));
  EXPECT_THAT(
      errorWith([](auto& b) { b.primitive()["attributes"]["JOINTS_0"] = b.primitive()["attributes"]["WEIGHTS_0"]; }),
      IsErrorAt("/meshes/0/primitives/0/attributes/JOINTS_0", "floats"));
}

TEST(GltfSkin, UsesTheNodeTransformWithoutJoints) {
  SkinBuilder builder;
  builder.primitive()["attributes"].erase("JOINTS_0");
  const scene::Scene scene = builder.load();
  EXPECT_EQ(vec3(scene.instances[0].worldFromObject[3]), vec3(100));
  EXPECT_THAT(scene.report.ignored, testing::Contains(IsErrorAt("/nodes/0/skin", "JOINTS_0")));
}

}  // namespace
}  // namespace quintet::test
