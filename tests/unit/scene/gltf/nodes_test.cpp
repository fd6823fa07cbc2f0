// SPDX-License-Identifier: Apache-2.0
// Node hierarchy, instances, cameras and lights.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "scene/error_matcher.h"
#include "scene/gltf/gltf.h"
#include "scene/gltf_builder.h"

namespace quintet::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

MATCHER_P(IsNear, expected, "") {
  return glm::distance(vec3(arg), vec3(expected)) <= 1e-5f * std::max(1.0f, glm::length(vec3(expected)));
}

vec3 worldPoint(const scene::Scene& scene, const vec3& p, std::size_t instance = 0) {
  return vec3(scene.instances.at(instance).worldFromObject * vec4(p, 1.0f));
}

TEST(GltfNodes, MultipliesTransformsAlongTheHierarchy) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.root["nodes"][0]["scale"] = {2, 3, 4};
  builder.add("nodes",
              {{"rotation", {0, 0, 0.7071067811865476, 0.7071067811865476}}, {"children", {0}}});  // 90° about z
  builder.add("nodes", {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1}}, {"children", {1}}});
  const scene::Scene scene = builder.load();
  EXPECT_THAT(worldPoint(scene, vec3(1, 1, 1)), IsNear(vec3(10 - 3, 20 + 2, 30 + 4)));
}

TEST(GltfNodes, NormalizesQuaternions) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.root["nodes"][0]["rotation"] = {0, 0, 2, 2};
  scene::Scene scene = builder.load();
  EXPECT_THAT(worldPoint(scene, vec3(1, 0, 0)), IsNear(vec3(0, 1, 0)));
  EXPECT_THAT(scene.report.repaired, ElementsAre(IsErrorAt("/nodes/0/rotation", "2.828")));
  builder.root["nodes"][0]["rotation"] = {0, 0, 0, 0};
  EXPECT_THAT(worldPoint(builder.load(), vec3(1, 0, 0)), IsNear(vec3(1, 0, 0)));
}

TEST(GltfNodes, SelectsTheNodesOfTheScene) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.root["nodes"][0]["name"] = "a";
  builder.add("nodes", {{"mesh", 0}, {"name", "b"}});
  const auto names = [](const scene::Scene& scene) {
    std::string all;
    for (const auto& instance : scene.instances) all += instance.name;
    return all;
  };
  EXPECT_EQ(names(builder.load()), "ab");
  builder.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1, 0}}}};
  EXPECT_EQ(names(builder.load()), "a");
  builder.root["scene"] = 1;
  EXPECT_EQ(names(builder.load()), "ba");

  const TempFolder folder;
  writeFile(folder / "scene.glb", builder.glb());
  EXPECT_EQ(names(scene::loadGltf(folder / "scene.glb", {.scene = "0"})), "a");
  EXPECT_THROW(scene::loadGltf(folder / "scene.glb", {.scene = "2"}), UsageError);
  builder.root["scene"] = 2;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/scene", "scene 2"));
}

TEST(GltfNodes, SelectsAScene) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.add("nodes", {{"mesh", 0}});
  builder.add("nodes", {{"mesh", 0}});
  builder.root["scenes"] = {{{"nodes", {0}}, {"name", "one"}}, {{"nodes", {1, 2}}, {"name", "0"}}};
  const TempFolder folder;
  writeFile(folder / "scene.glb", builder.glb());
  const auto count = [&](const std::string& scene) {
    return scene::loadGltf(folder / "scene.glb", {.scene = scene}).instances.size();
  };
  EXPECT_EQ(count("one"), 1u);
  EXPECT_EQ(count("0"), 2u);  // a name has precedence over an index
  EXPECT_EQ(count("1"), 2u);
  for (const char* name : {"two", "2", "-1", "1x"})
    EXPECT_THAT([&] { count(name); }, testing::ThrowsMessage<UsageError>(
                                          testing::AllOf(testing::HasSubstr("scene.glb"), testing::HasSubstr(name),
                                                         testing::HasSubstr("2 scenes: one, 0"))));
}

// A node is visible if it and all its ancestors are (KHR_node_visibility).
TEST(GltfNodes, HidesNodesAndTheirDescendants) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  builder.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
  const auto visibility = [](bool visible) { return Json{{"KHR_node_visibility", {{"visible", visible}}}}; };
  builder.add("nodes", {{"mesh", 0}, {"camera", 0}, {"extensions", visibility(true)}});
  builder.root["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  builder.add("nodes", {{"children", {1}}, {"extensions", visibility(false)}});
  builder.add("nodes", {{"mesh", 0}, {"extensions", {{"KHR_node_visibility", Json::object()}}}});
  scene::Scene scene = builder.load();
  EXPECT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.lights.size(), 0u);
  EXPECT_EQ(scene.cameras.size(), 1u);
  EXPECT_TRUE(scene.report.isExact());
  builder.root["nodes"][2]["extensions"] = visibility(true);
  scene = builder.load();
  EXPECT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.lights.size(), 1u);
  builder.root["nodes"][2]["extensions"]["KHR_node_visibility"]["visible"] = 0;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/nodes/2/extensions/KHR_node_visibility/visible", "true or false"));
}

// Each node is visited once, without recursion.
TEST(GltfNodes, ReadsDeepHierarchies) {
  GltfBuilder builder;
  builder.addTriangle();
  constexpr int kDepth = 20000;
  for (int i = 0; i < kDepth; ++i)
    builder.root["nodes"].push_back({{"children", {i}}, {"translation", {1.0 / kDepth, 0, 0}}});
  EXPECT_THAT(worldPoint(builder.load(), vec3(0)), IsNear(vec3(1, 0, 0)));
}

TEST(GltfNodes, RejectsCyclesAndSecondParents) {
  const auto errorWith = [](const Json& nodes, const Json& roots = nullptr) {
    GltfBuilder builder;
    builder.root["nodes"] = nodes;
    if (!roots.is_null()) builder.root["scenes"] = {{{"nodes", roots}}};
    return errorOf(builder);
  };
  const Json leaf = Json::object();
  EXPECT_THAT(errorWith({{{"children", {0}}}}), IsErrorAt("/nodes/0", "ancestor"));
  EXPECT_THAT(errorWith({leaf, {{"children", {2}}}, {{"children", {1}}}}), IsErrorAt("/nodes/1", "ancestor"));
  EXPECT_THAT(errorWith({{{"children", {2}}}, {{"children", {2}}}, leaf}),
              IsErrorAt("/nodes/1/children/0", "child of node 0"));
  EXPECT_THAT(errorWith({{{"children", {1, 1}}}, leaf}), IsErrorAt("/nodes/0/children/1", "child of node 0"));
  EXPECT_THAT(errorWith({{{"children", {5}}}}), IsErrorAt("/nodes/0/children/0", "node 5"));
  EXPECT_THAT(errorWith({{{"children", {1}}}, leaf}, {1}), IsErrorAt("/scenes/0/nodes/0", "child of node 0"));
  EXPECT_THAT(errorWith(Json::array({leaf}), {0, 0}), IsErrorAt("/scenes/0/nodes/1", "twice"));
  EXPECT_THAT(errorWith(Json::array({leaf}), {3}), IsErrorAt("/scenes/0/nodes/0", "node 3"));
}

TEST(GltfNodes, LoadsDeepHierarchies) {
  GltfBuilder builder;
  builder.addTriangle();
  constexpr int kDepth = 20000;
  for (int i = 1; i < kDepth; ++i) builder.add("nodes", {{"translation", {1, 0, 0}}, {"children", {i - 1}}});
  EXPECT_THAT(worldPoint(builder.load(), vec3(0)), IsNear(vec3(kDepth - 1, 0, 0)));
}

TEST(GltfNodes, RejectsInvalidTransforms) {
  const auto errorWith = [](const Json& node) {
    GltfBuilder builder;
    builder.root["nodes"] = Json::array({node});
    return errorOf(builder);
  };
  EXPECT_THAT(errorWith({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2}}}),
              IsErrorAt("/nodes/0/matrix", "last row"));
  EXPECT_THAT(errorWith({{"matrix", {1, 0, 0}}}), IsErrorAt("/nodes/0/matrix", "16 numbers"));
  EXPECT_THAT(errorWith({{"scale", {1, "x", 1}}}), IsErrorAt("/nodes/0/scale/1", "number"));
  EXPECT_EQ(errorWith({{"translation", {1e39, 0, 0}}}), "");
  EXPECT_EQ(errorWith({{"scale", {1e30, 1, 1}}, {"translation", {1e30, 0, 0}}}), "");
  GltfBuilder builder;
  builder.root["nodes"] = {{{"scale", {1e30, 1, 1}}, {"children", {1}}}, {{"scale", {1e30, 1, 1}}}};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/nodes/1", "not finite"));
}

TEST(GltfNodes, KeepsMirroringInTheTransform) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.root["nodes"][0]["scale"] = {-1, 1, 1};
  const scene::Scene scene = builder.load();
  EXPECT_LT(glm::determinant(mat3(scene.instances[0].worldFromObject)), 0.0f);
  EXPECT_THAT(scene.meshes[0].geometries[0].triangles, ElementsAre(uvec3(0, 1, 2)));
}

TEST(GltfNodes, BakesFlattenedMeshes) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.primitive()["attributes"]["NORMAL"] = builder.addAccessor<float>({1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3");
  builder.root["nodes"][0]["scale"] = {2, 3, 0};
  builder.root["nodes"][0]["translation"] = {0, 0, 5};
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.instances.at(0).worldFromObject, mat4(1.0f));
  EXPECT_THAT(scene.meshes[0].geometries[0].positions, ElementsAre(vec3(0, 0, 5), vec3(2, 0, 5), vec3(0, 3, 5)));
  EXPECT_THAT(scene.meshes[0].geometries[0].normals, IsEmpty());
  builder.root["nodes"][0]["scale"] = {0, 0, 0};
  EXPECT_THAT(builder.load().instances, IsEmpty());
  EXPECT_THAT(builder.load().report.ignored, ElementsAre(IsErrorAt("/nodes/0", "scale")));
}

TEST(GltfNodes, KeepsTinyAndHugeScales) {
  GltfBuilder builder;
  builder.addTriangle();
  for (const double scale : {1e-14, 1e14}) {
    builder.root["nodes"][0]["scale"] = {scale, scale, scale};
    EXPECT_NE(builder.load().instances.at(0).worldFromObject, mat4(1.0f));
  }
}

struct InstancingBuilder : GltfBuilder {
  InstancingBuilder() {
    addTriangle();
    root["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    attributes()["TRANSLATION"] = addAccessor<float>({1, 0, 0, 0, 2, 0}, "VEC3");
    attributes()["ROTATION"] = addAccessor<std::int8_t>({0, 0, 0, 127, 0, 0, 127, 0}, "VEC4", true);
    attributes()["SCALE"] = addAccessor<float>({1, 1, 1, 2, 2, 2}, "VEC3");
    root["nodes"][0]["translation"] = {0, 0, 10};
  }
  Json& attributes() { return root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]; }
};

TEST(GltfInstancing, ReadsOneTransformPerInstance) {
  const scene::Scene scene = InstancingBuilder().load();
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_THAT(worldPoint(scene, vec3(1, 0, 0), 0), IsNear(vec3(2, 0, 10)));
  EXPECT_THAT(worldPoint(scene, vec3(1, 0, 0), 1), IsNear(vec3(-2, 2, 10)));  // half a turn about z, twice as large
  EXPECT_EQ(scene::countTriangles(scene).stored, 1u);
  EXPECT_EQ(scene::countTriangles(scene).instanced, 2u);
}

TEST(GltfInstancing, RejectsInconsistentAttributes) {
  InstancingBuilder builder;
  const std::string location = "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes";
  builder.attributes()["SCALE"] = builder.addAccessor<float>({1, 1, 1}, "VEC3");
  EXPECT_THAT(errorOf(builder), IsErrorAt(location, "counts"));
  builder.attributes()["SCALE"] = 99;
  EXPECT_THAT(errorOf(builder), IsErrorAt(location + "/SCALE", "accessor 99"));
  builder.attributes()["SCALE"] = builder.attributes()["ROTATION"];
  EXPECT_THAT(errorOf(builder), IsErrorAt(location + "/SCALE", "VEC4"));
}

TEST(GltfCamera, ReadsPerspectiveCameras) {
  GltfBuilder builder;
  builder.add("cameras", {{"type", "perspective"},
                          {"name", "main"},
                          {"perspective", {{"yfov", 0.5}, {"aspectRatio", 1.5}, {"znear", 0.1}}}});
  // Scaled, mirrored, translated, looking along +x.
  builder.add("nodes", {{"camera", 0},
                        {"name", "Camera.001"},
                        {"translation", {1, 2, 3}},
                        {"scale", {-2, 3, 4}},
                        {"rotation", {0, -0.7071067811865476, 0, 0.7071067811865476}}});
  const scene::Camera camera = builder.load().cameras.at(0);
  EXPECT_EQ(camera.name, "main");
  EXPECT_EQ(camera.nodeName, "Camera.001");
  EXPECT_FALSE(camera.orthographic);
  EXPECT_FLOAT_EQ(camera.verticalFov, 0.5f);
  EXPECT_FLOAT_EQ(camera.aspect, 1.5f);
  EXPECT_EQ(camera.apertureRadius, 0.0f);
  EXPECT_THAT(camera.worldFromCamera[3], IsNear(vec3(1, 2, 3)));
  EXPECT_THAT(-camera.worldFromCamera[2], IsNear(vec3(1, 0, 0)));
  EXPECT_THAT(camera.worldFromCamera[1], IsNear(vec3(0, 1, 0)));
  EXPECT_NEAR(glm::determinant(mat3(camera.worldFromCamera)), 1.0f, 1e-5f);
}

TEST(GltfCamera, ReadsOrthographicCameras) {
  GltfBuilder builder;
  builder.add("cameras",
              {{"type", "orthographic"}, {"orthographic", {{"xmag", 4}, {"ymag", -2}, {"znear", 0}, {"zfar", 9}}}});
  builder.add("nodes", {{"camera", 0}, {"name", "node"}});
  const scene::Camera camera = builder.load().cameras.at(0);
  EXPECT_TRUE(camera.orthographic);
  EXPECT_EQ(camera.name, "node");
  EXPECT_EQ(camera.orthographicHalfSize, vec2(4, 2));
  EXPECT_EQ(camera.aspect, 2.0f);
  builder.root["cameras"][0]["orthographic"]["xmag"] = 0;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/cameras/0/orthographic", "xmag"));
}

TEST(GltfCamera, RejectsInvalidCameras) {
  GltfBuilder builder;
  builder.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 4}, {"znear", 0.1}}}});
  builder.add("nodes", {{"camera", 0}});
  EXPECT_THAT(errorOf(builder), IsErrorAt("/cameras/0/perspective/yfov", "angle"));
  builder.root["cameras"][0]["perspective"].erase("yfov");
  EXPECT_THAT(errorOf(builder), IsErrorAt("/cameras/0/perspective", "yfov"));
  builder.root["cameras"][0].erase("perspective");
  EXPECT_THAT(errorOf(builder), IsErrorAt("/cameras/0", "perspective"));
  builder.root["cameras"][0]["type"] = "fisheye";
  EXPECT_THAT(errorOf(builder), IsErrorAt("/cameras/0/type", "fisheye"));
  builder.root["nodes"][0]["camera"] = 1;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/cameras/0/type", "fisheye"));
}

struct LightBuilder : GltfBuilder {
  explicit LightBuilder(const Json& light) {
    root["extensionsUsed"] = {"KHR_lights_punctual"};
    root["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({light});
    add("nodes", {{"translation", {1, 2, 3}},
                  {"rotation", {0, 0.7071067811865476, 0, 0.7071067811865476}},  // -z becomes -x
                  {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  }
};

TEST(GltfLight, ReadsPointSpotAndDirectionalLights) {
  const scene::Light point =
      LightBuilder({{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 8}, {"range", 5}}).load().lights.at(0);
  EXPECT_EQ(point.type, scene::LightType::point);
  EXPECT_EQ(point.intensity, vec3(8, 4, 0));
  EXPECT_THAT(point.position, IsNear(vec3(1, 2, 3)));
  EXPECT_EQ(point.range, 5.0f);

  const scene::Light spot =
      LightBuilder({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.3}}}})
          .load()
          .lights.at(0);
  EXPECT_EQ(spot.type, scene::LightType::spot);
  EXPECT_EQ(spot.intensity, vec3(1));
  EXPECT_THAT(spot.direction, IsNear(vec3(-1, 0, 0)));
  EXPECT_FLOAT_EQ(spot.innerConeAngle, 0.1f);
  EXPECT_FLOAT_EQ(spot.outerConeAngle, 0.3f);
  EXPECT_TRUE(std::isinf(spot.range));

  const scene::Light sun = LightBuilder({{"type", "directional"}, {"name", "sun"}}).load().lights.at(0);
  EXPECT_EQ(sun.type, scene::LightType::directional);
  EXPECT_EQ(sun.name, "sun");
  EXPECT_THAT(sun.direction, IsNear(vec3(-1, 0, 0)));
}

TEST(GltfLight, RepairsNegativeIntensities) {
  const scene::Scene scene = LightBuilder({{"type", "point"}, {"color", {1, -1, 1}}, {"range", -2}}).load();
  EXPECT_EQ(scene.lights.at(0).intensity, vec3(1, 0, 1));
  EXPECT_TRUE(std::isinf(scene.lights.at(0).range));
  EXPECT_THAT(scene.report.repaired, ElementsAre(IsErrorAt("/extensions/KHR_lights_punctual/lights/0", "negative"),
                                                 IsErrorAt("/extensions/KHR_lights_punctual/lights/0", "range -2")));
}

TEST(GltfLight, RepairsSpotAngles) {
  const scene::Light spot = LightBuilder({{"type", "spot"}, {"spot", Json::object()}}).load().lights.at(0);
  EXPECT_EQ(spot.innerConeAngle, 0.0f);
  EXPECT_FLOAT_EQ(spot.outerConeAngle, kPi / 4);
  const scene::Scene wide =
      LightBuilder({{"type", "spot"}, {"spot", {{"innerConeAngle", 3}, {"outerConeAngle", 2}}}}).load();
  EXPECT_FLOAT_EQ(wide.lights.at(0).outerConeAngle, kPi / 2);
  EXPECT_FLOAT_EQ(wide.lights.at(0).innerConeAngle, kPi / 2);
  EXPECT_EQ(wide.report.repaired.size(), 1u);
}

TEST(GltfLight, ReportsUnknownTypesAndChecksIndices) {
  LightBuilder builder(Json{{"type", "area"}});
  EXPECT_THAT(builder.load().lights, IsEmpty());
  EXPECT_THAT(builder.load().report.ignored,
              ElementsAre(IsErrorAt("/extensions/KHR_lights_punctual/lights/0", "area")));
  builder.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 1;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/nodes/0/extensions/KHR_lights_punctual/light", "light 1"));
  builder.root.erase("extensions");
  EXPECT_THAT(errorOf(builder), IsErrorAt("/nodes/0/extensions/KHR_lights_punctual/light", "light 1"));
}

TEST(GltfReport, ListsAnimationsAndAsset) {
  GltfBuilder builder;
  builder.root["animations"] = Json::parse(R"([{"name": "Walk", "channels": [], "samplers": []}])");
  builder.root["asset"]["generator"] = "by hand";
  builder.root["asset"]["copyright"] = "none";
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.name, "scene.glb");
  EXPECT_EQ(scene.report.generator, "by hand");
  EXPECT_EQ(scene.report.copyright, "none");
  ASSERT_EQ(scene.report.animations.size(), 1u);
  EXPECT_EQ(scene.report.animations[0].name, "Walk");
  EXPECT_THAT(scene.report.ignored, IsEmpty());
}

}  // namespace
}  // namespace quintet::test
