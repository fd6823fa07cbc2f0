// SPDX-License-Identifier: Apache-2.0
// KHR_animation_pointer: properties of materials, lights, cameras and nodes that follow a sampler.
#include <gmock/gmock.h>

#include "scene/animation/pose.h"
#include "scene/error_matcher.h"
#include "scene/gltf_animation.h"
#include "scene/model/content_hash.h"
#include "scene/model/surface_class.h"

namespace quintet::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// A triangle with a material, a camera at node 1 and a point light at node 2. One second has 24 frames.
AnimationBuilder pointerScene() {
  AnimationBuilder builder;
  builder.addTriangle();
  builder.add("materials", {{"name", "M"}, {"emissiveFactor", {1, 0.5f, 0}}});
  builder.primitive()["material"] = 0;
  builder.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  builder.add("nodes", {{"camera", 0}});
  builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = Json::array(
      {{{"type", "spot"}, {"color", {1, 0.5f, 0}}, {"intensity", 4.0}, {"spot", {{"outerConeAngle", 0.5}}}}});
  builder.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return builder;
}

scene::Scene pointerPose(const AnimationBuilder& builder, double frame) {
  scene::Scene scene = builder.loadAnimated();
  EXPECT_THAT(scene.report.ignored, IsEmpty());
  scene::applyPose(scene, scene::poseAt(scene.nodeAnimation.get(), frame));
  return scene;
}

void expectColor(const vec3& value, const vec3& expected) {
  EXPECT_LT(glm::distance(value, expected), 1e-5f) << value.x << " " << value.y << " " << value.z;
}

TEST(AnimationPointer, FactorsOfMaterialsFollow) {
  AnimationBuilder builder = pointerScene();
  builder.addPointer("/materials/0/pbrMetallicRoughness/baseColorFactor", {0, 1}, {0, 0, 0, 1, 1, 0.5f, 0.25f, 1},
                     "VEC4");
  builder.addPointer("/materials/0/pbrMetallicRoughness/roughnessFactor", {0, 1}, {0, 4}, "SCALAR");
  builder.addPointer("/materials/0/extensions/KHR_materials_clearcoat/clearcoatFactor", {0, 1}, {0, 1}, "SCALAR",
                     "STEP");
  const scene::Material start = pointerPose(builder, 0).materials[0], middle = pointerPose(builder, 12).materials[0],
                        end = pointerPose(builder, 24).materials[0];
  EXPECT_EQ(start.baseColor, vec4(0, 0, 0, 1));
  EXPECT_EQ(middle.baseColor, vec4(0.5f, 0.25f, 0.125f, 1));
  EXPECT_EQ(start.roughness, 0.0f);
  EXPECT_EQ(end.roughness, 1.0f) << "clamped";
  EXPECT_EQ(middle.clearcoat, 0.0f);
  EXPECT_EQ(end.clearcoat, 1.0f);
  EXPECT_EQ(middle.metallic, 1.0f) << "not animated";
}

// The emission is the product of a color and a strength, of which either or both can be animated.
TEST(AnimationPointer, EmissionIsAProduct) {
  const std::string strength = "KHR_materials_emissive_strength", material = "/materials/0/";
  AnimationBuilder builder = pointerScene();
  builder.root["extensionsUsed"].push_back(strength);
  builder.root["materials"][0]["extensions"][strength]["emissiveStrength"] = 2.0;
  AnimationBuilder color = builder, factor = builder, both = builder;
  color.addPointer(material + "emissiveFactor", {0, 1}, {0, 0, 0, 1, 2, 3}, "VEC3");
  expectColor(pointerPose(color, 12).materials[0].emissive, {1, 2, 3});
  factor.addPointer(material + "extensions/" + strength + "/emissiveStrength", {0, 1}, {0, 8}, "SCALAR");
  expectColor(pointerPose(factor, 0).materials[0].emissive, {0, 0, 0});
  expectColor(pointerPose(factor, 12).materials[0].emissive, {4, 2, 0});
  both.addPointer(material + "extensions/" + strength + "/emissiveStrength", {0, 1}, {0, 8}, "SCALAR");
  both.addPointer(material + "emissiveFactor", {0, 1}, {0, 0, 0, 1, 2, 3}, "VEC3");
  expectColor(pointerPose(both, 12).materials[0].emissive, {2, 4, 6});
}

TEST(AnimationPointer, TextureTransformsFollow) {
  AnimationBuilder builder = pointerScene();
  const std::string use = "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/";
  builder.addPointer(use + "offset", {0, 1}, {0, 0, 1, 2}, "VEC2");
  EXPECT_THAT(builder.load().report.ignored,
              ElementsAre(IsErrorAt("/animations/0/channels/0/target/extensions/KHR_animation_pointer/pointer",
                                    "does not use this texture")));
  builder.add("images", {{"bufferView", builder.addView(tinyPng())}, {"mimeType", "image/png"}});
  builder.add("textures", {{"source", 0}});
  builder.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
  builder.addPointer(use + "scale", {0, 1}, {1, 1, 3, 5}, "VEC2");
  builder.addPointer(use + "rotation", {0, 1}, {0, 1}, "SCALAR");
  const scene::TextureUse middle = pointerPose(builder, 12).materials[0].baseColorTexture;
  EXPECT_EQ(middle.offset, vec2(0.5f, 1));
  EXPECT_EQ(middle.scale, vec2(2, 3));
  EXPECT_EQ(middle.rotation, 0.5f);
}

TEST(AnimationPointer, LightsAndCamerasFollow) {
  AnimationBuilder builder = pointerScene();
  const std::string light = "/extensions/KHR_lights_punctual/lights/0/";
  AnimationBuilder color = builder, rest = builder;
  color.addPointer(light + "color", {0, 1}, {0, 0, 0, 1, 1, 0.5f}, "VEC3");
  expectColor(pointerPose(color, 12).lights[0].intensity, {2, 2, 1});
  rest.addPointer(light + "intensity", {0, 1}, {0, 20}, "SCALAR");
  rest.addPointer(light + "range", {0, 1}, {2, 4}, "SCALAR");
  rest.addPointer(light + "spot/innerConeAngle", {0, 1}, {0, 1}, "SCALAR");
  rest.addPointer(light + "spot/outerConeAngle", {0, 1}, {0.5f, 1.5f}, "SCALAR");
  rest.addPointer("/cameras/0/perspective/yfov", {0, 1}, {0.5f, 1}, "SCALAR");
  const scene::Scene middle = pointerPose(rest, 12);
  expectColor(middle.lights[0].intensity, {10, 5, 0});
  EXPECT_EQ(middle.lights[0].range, 3);
  EXPECT_EQ(middle.lights[0].innerConeAngle, 0.5f);
  EXPECT_EQ(middle.lights[0].outerConeAngle, 1);
  EXPECT_EQ(middle.cameras[0].verticalFov, 0.75f);
}

TEST(AnimationPointer, NodesFollowAsWithPlainChannels) {
  AnimationBuilder plain = morphingTriangle(), pointers = morphingTriangle();
  plain.addChannel(0, "translation", {0, 1}, {0, 0, 0, 1, 2, 3});
  pointers.addPointer("/nodes/0/translation", {0, 1}, {0, 0, 0, 1, 2, 3}, "VEC3");
  const scene::Scene a = pointerPose(plain, 6), b = pointerPose(pointers, 6);
  EXPECT_EQ(a.instances[0].worldFromObject, b.instances[0].worldFromObject);
  EXPECT_EQ(a.meshes[0].geometries[0].positions, b.meshes[0].geometries[0].positions);

  AnimationBuilder weights = morphingTriangle();
  weights.root["nodes"][0].erase("weights");
  weights.root.erase("animations");
  weights.addPointer("/meshes/0/weights", {0, 1}, {0, 0, 1, 1}, "SCALAR");
  EXPECT_THAT(scene::poseAt(weights.loadAnimated().nodeAnimation.get(), 12).weights[0], ElementsAre(0.5f, 0.5f));
}

// The light's node is a child of the triangle's, which is hidden in the second half.
TEST(AnimationPointer, VisibilityIsInherited) {
  AnimationBuilder builder = pointerScene();
  builder.root["nodes"][0]["children"] = {2};
  builder.addPointer("/nodes/0/extensions/KHR_node_visibility/visible", {0, 0.5f}, {1, 0}, "SCALAR", "STEP");
  const auto shown = [](const scene::Scene& scene) {
    return glm::determinant(mat3(scene.instances[0].worldFromObject)) != 0.0f;
  };
  EXPECT_TRUE(shown(pointerPose(builder, 6)));
  EXPECT_FALSE(shown(pointerPose(builder, 18)));
  EXPECT_EQ(pointerPose(builder, 6).lights[0].intensity, vec3(4, 2, 0));
  EXPECT_EQ(pointerPose(builder, 18).lights[0].intensity, vec3(0));
  // Hidden at rest and at frame 0, shown later.
  builder.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
  builder.root["animations"][0]["samplers"][0]["output"] = builder.addAccessor<std::uint8_t>({0, 1}, "SCALAR");
  EXPECT_TRUE(builder.load().instances.empty());
  EXPECT_FALSE(shown(pointerPose(builder, 6)));
  EXPECT_TRUE(shown(pointerPose(builder, 18)));
  EXPECT_EQ(pointerPose(builder, 18).lights[0].intensity, vec3(4, 2, 0)) << "not lost at frame 0";
}

TEST(AnimationPointer, UnknownPointersAreReported) {
  AnimationBuilder builder = pointerScene();
  const std::vector<std::pair<std::string, std::string>> pointers{
      {"/materials/0/color", "\"/materials/0/color\": the property is unknown"},
      {"/materials/7/alphaCutoff", "material 7 does not exist"},
      {"/materials/0", "is unknown"},
      {"/materials/x/alphaCutoff", "is unknown"},
      {"/materials/0/occlusionTexture/strength", "has no effect"},
      {"/nodes/0/weights", "no morph targets"},
      {"/nodes/0/name", "is unknown"},
      {"/meshes/0/primitives", "is unknown"},
      {"/cameras/0/orthographic/xmag", "camera 0 is perspective"},
      {"/cameras/0/perspective/aspectRatio", "the size of the image does not change"},
      {"/cameras/0/perspective/znear", "has no effect"},
      {"/extensions/KHR_lights_punctual/lights/0/type", "is unknown"},
      {"/extensions/KHR_lights_punctual/lights/0/position", "is unknown"},
      {"/extensions/KHR_lights_punctual/lights/0/", "is unknown"},
      {"/cameras/0/look_from", "is unknown"},
      {"", "is unknown"}};
  std::vector<testing::Matcher<std::string>> expected;
  for (std::size_t i = 0; i < pointers.size(); ++i) {
    builder.addPointer(pointers[i].first, {0, 1}, {0, 1}, "SCALAR");
    expected.push_back(
        IsErrorAt("/animations/0/channels/" + std::to_string(i) + "/target/extensions/KHR_animation_pointer/pointer",
                  pointers[i].second));
  }
  builder.addPointer("/materials/0/alphaCutoff", {0, 1}, {0, 1}, "SCALAR");
  builder.addPointer("/materials/0/alphaCutoff", {0, 1}, {1, 0}, "SCALAR");
  expected.push_back(IsErrorAt("/animations/0/channels/17/target/extensions/KHR_animation_pointer/pointer",
                               "/materials/0/alphaCutoff is already animated"));
  const scene::Report report = builder.load().report;
  EXPECT_THAT(report.ignored, testing::ElementsAreArray(expected));
  EXPECT_EQ(report.animations[0].ignored, pointers.size() + 1);
  EXPECT_THAT(report.extensionsUsed, testing::Contains("KHR_animation_pointer"));
  EXPECT_EQ(builder.loadAnimated().nodeAnimation->materials.size(), 1u);
}

// What a material has only for a part of the time decides which shaders and any-hit tests the scene needs.
TEST(AnimationPointer, SurfacesHaveTheClassesOfAllTimes) {
  AnimationBuilder builder = pointerScene();
  builder.root["materials"][0]["alphaMode"] = "BLEND";
  EXPECT_FALSE(scene::needsAlphaTest(builder.loadAnimated(), builder.loadAnimated().meshes[0].geometries[0]));
  builder.addPointer("/materials/0/pbrMetallicRoughness/baseColorFactor", {0, 1, 2},
                     {1, 1, 1, 1, 1, 1, 1, 0, 1, 1, 1, 1}, "VEC4");
  const scene::Scene scene = builder.loadAnimated();
  EXPECT_EQ(scene.materials[0].baseColor.a, 1.0f);
  EXPECT_TRUE(scene::needsAlphaTest(scene, scene.meshes[0].geometries[0]));
  EXPECT_TRUE(scene::tintsShadows(scene, scene.meshes[0].geometries[0]));
  EXPECT_FALSE(scene::isPane(scene, scene.meshes[0].geometries[0]));
}

TEST(AnimationPointer, IsPartOfTheHash) {
  AnimationBuilder one = pointerScene(), other = pointerScene();
  one.addPointer("/materials/0/pbrMetallicRoughness/roughnessFactor", {0, 1}, {1, 0}, "SCALAR");
  other.addPointer("/materials/0/pbrMetallicRoughness/metallicFactor", {0, 1}, {1, 0}, "SCALAR");
  EXPECT_NE(scene::contentHash(one.loadAnimated()).hex(), scene::contentHash(other.loadAnimated()).hex());
}

}  // namespace
}  // namespace quintet::test
