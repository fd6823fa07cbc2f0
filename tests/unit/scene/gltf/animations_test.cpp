// SPDX-License-Identifier: Apache-2.0
// Animations of glTF files: the summary, the choice, what each channel moves, and errors.
#include "scene/gltf/animations.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "base/error.h"
#include "base/file.h"
#include "scene/animation/pose.h"
#include "scene/error_matcher.h"
#include "scene/gltf_animation.h"
#include "scene/load.h"
#include "scene/model/content_hash.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

AnimationBuilder twoAnimations() {
  AnimationBuilder builder = movingTriangle();
  builder.addAnimation("Walk");
  builder.addChannel(1, "translation", {0, 1.5f}, {0, 0, 0, 3, 0, 0});
  builder.addAnimation("Run");
  builder.addChannel(1, "translation", {0, 0.5f}, {5, 0, 0, 3, 0, 0});
  builder.addChannel(0, "scale", {0, 0.25f}, {1, 1, 1, 2, 2, 2});
  return builder;
}

std::string errorOfPlaying(const AnimationBuilder& builder) {
  try {
    builder.loadAnimated();
  } catch (const FileError& error) {
    return error.location() + ": " + error.problem();
  }
  return "";
}

TEST(GltfAnimations, AreSummarized) {
  const scene::Report report = twoAnimations().load().report;
  ASSERT_EQ(report.animations.size(), 2u);
  EXPECT_EQ(report.animations[0].name, "Walk");
  EXPECT_DOUBLE_EQ(report.animations[0].seconds, 1.5);
  EXPECT_EQ(report.animations[0].channels, 1u);
  EXPECT_EQ(report.animations[1].name, "Run");
  EXPECT_DOUBLE_EQ(report.animations[1].seconds, 0.5);
  EXPECT_EQ(report.animations[1].channels, 2u);
  EXPECT_THAT(report.ignored, IsEmpty());
}

TEST(GltfAnimations, TheReportTellsWhichOnePlays) {
  const auto usesOf = [](const scene::Scene& scene) {
    std::vector<std::string> uses;
    for (const scene::Feature& feature : scene.report.features)
      if (feature.kind == "animation") uses.push_back(feature.name + ": " + nameOf(feature.use));
    return uses;
  };
  const AnimationBuilder builder = twoAnimations();
  EXPECT_THAT(usesOf(builder.loadAnimated("Run")), ElementsAre("Walk: unused", "Run: used"));
  EXPECT_THAT(usesOf(builder.load()), ElementsAre("Walk: unused", "Run: unused"));
}

TEST(GltfAnimations, AreChosenByNameOrIndex) {
  const AnimationBuilder builder = twoAnimations();
  const auto startOf = [&](const char* name) { return builder.loadAnimated(name).instances[0].worldFromObject[3].x; };
  EXPECT_EQ(startOf(""), 0);
  EXPECT_EQ(startOf("Walk"), 0);
  EXPECT_EQ(startOf("Run"), 5);
  EXPECT_EQ(startOf("1"), 5);
  EXPECT_THAT([&] { startOf("Rum"); },
              ThrowsMessage<UsageError>(AllOf(HasSubstr("no animation 'Rum'"), HasSubstr("Walk, Run"))));
  EXPECT_THAT([&] { startOf("2"); }, ThrowsMessage<UsageError>(HasSubstr("no animation '2'")));
}

TEST(GltfAnimations, FilesWithoutAnimationsPlayNone) {
  EXPECT_EQ(movingTriangle().loadAnimated().nodeAnimation, nullptr);
  EXPECT_THAT([] { movingTriangle().loadAnimated("Walk"); },
              ThrowsMessage<UsageError>(HasSubstr("the file has no animations")));
  AnimationBuilder builder = movingTriangle();
  builder.addAnimation("Nothing");
  EXPECT_EQ(builder.loadAnimated().nodeAnimation, nullptr) << "an animation without channels";
  const TempFolder folder;
  writeFile(folder / "a.scene.toml", "");
  EXPECT_THAT([&] { scene::loadScene(folder / "a.scene.toml", {.animation = "Walk"}); },
              ThrowsMessage<UsageError>(HasSubstr("only glTF files have named animations")));
}

// Static parts of an animated file are shared and copied as without animation.
TEST(GltfAnimations, MoveOnlyWhatTheirChannelsReach) {
  AnimationBuilder builder = movingTriangle();
  builder.add("nodes", {{"mesh", 0}, {"translation", {0, 0, 9}}});
  builder.addChannel(1, "translation", {0, 1}, {0, 0, 0, 3, 0, 0});
  const scene::Scene scene = builder.loadAnimated();
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].node, 0);
  EXPECT_EQ(scene.instances[1].node, scene::kNone);
  EXPECT_EQ(scene.instances[0].mesh, scene.instances[1].mesh) << "a mesh that does not deform is shared";
  EXPECT_EQ(scene.meshes[0].deformation, nullptr);
}

TEST(GltfAnimations, TheHashDependsOnTheAnimation) {
  const AnimationBuilder builder = twoAnimations();
  const auto hash = [&](const std::optional<std::string>& name, double rate = 24) {
    return scene::contentHash(builder.loadAnimated(name, rate)).hex();
  };
  EXPECT_NE(hash("Walk"), hash("Run"));
  EXPECT_NE(hash("Walk"), hash("Walk", 30));
  EXPECT_NE(hash("Walk"), hash(std::nullopt));
  AnimationBuilder without = twoAnimations();
  without.root.erase("animations");
  EXPECT_EQ(hash(std::nullopt), scene::contentHash(without.loadAnimated(std::nullopt)).hex());
}

// Weights that no channel animates stay those of the node, or those of its mesh if it has none.
TEST(GltfAnimations, KeepTheWeightsThatAreNotAnimated) {
  AnimationBuilder builder = morphingTriangle();
  builder.root.erase("animations");
  builder.addChannel(0, "translation", {0, 1}, {0, 0, 0, 1, 2, 3});
  const auto weights = [&] { return scene::poseAt(builder.loadAnimated().nodeAnimation.get(), 12).weights.at(0); };
  EXPECT_THAT(weights(), ElementsAre(0.5f, 0.0f));
  builder.root["nodes"][0]["weights"] = {0, 0.25};
  EXPECT_THAT(weights(), ElementsAre(0.0f, 0.25f));
}

TEST(GltfAnimations, ReportChannelsThatCannotPlay) {
  AnimationBuilder builder = movingTriangle();
  builder.addChannel(1, "translation", {0, 1}, {0, 0, 0, 3, 0, 0});
  builder.addChannel(1, "translation", {0, 1}, {0, 0, 0, 4, 0, 0});
  builder.addChannel(0, "weights", {0, 1}, {0, 1});
  builder.addChannel(0, "pointer", {0, 1}, {0, 0, 0, 4, 0, 0});
  builder.root["animations"][0]["channels"][3]["target"].erase("node");
  builder.add("nodes", {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}});
  builder.addChannel(2, "scale", {0, 1}, {0, 0, 0, 4, 0, 0});
  const scene::Report report = builder.load().report;
  EXPECT_THAT(report.ignored, ElementsAre(IsErrorAt("/animations/0/channels/1/target", "already animated"),
                                          IsErrorAt("/animations/0/channels/2/target", "no morph targets"),
                                          IsErrorAt("/animations/0/channels/3/target", "\"pointer\" is not supported"),
                                          IsErrorAt("/animations/0/channels/4/target", "has a matrix")));
  EXPECT_EQ(std::ranges::count(report.features, "animation channel", &scene::Feature::kind), 4);
  EXPECT_EQ(report.animations[0].channels, 5u);
  EXPECT_EQ(report.animations[0].ignored, 4u);
  EXPECT_EQ(builder.loadAnimated().nodeAnimation->animation.channels.size(), 1u);
}

TEST(GltfAnimations, InvalidSamplersAreErrorsOnlyWhenTheyPlay) {
  const auto broken = [](const std::vector<float>& times, const std::vector<float>& values,
                         const std::string& interpolation = "LINEAR") {
    AnimationBuilder builder = movingTriangle();
    builder.addChannel(1, "translation", times, values, interpolation);
    return builder;
  };
  const auto expectError = [](const AnimationBuilder& builder, const char* location, const char* words) {
    EXPECT_THAT(errorOfPlaying(builder), IsErrorAt(location, words));
    EXPECT_EQ(builder.load().instances.size(), 1u) << "the rest pose does not depend on it";
  };
  const char* input = "/animations/0/samplers/0/input";
  const char* output = "/animations/0/samplers/0/output";
  const float nan = std::numeric_limits<float>::quiet_NaN();
  expectError(broken({0, 0}, {0, 0, 0, 1, 1, 1}), input, "not after");
  expectError(broken({0, nan}, {0, 0, 0, 1, 1, 1}), input, "not finite");
  expectError(broken({0, 1}, {0, 0, 0}), output, "3 numbers for 2 times");
  expectError(broken({0, 1}, {0, 0, 0, 1, 1, 1}, "CUBICSPLINE"), output, "9 each");
  expectError(broken({0, 1}, {0, 0, 0, 1, nan, 1}), output, "not finite");
  EXPECT_THAT(broken({0, 0}, {0, 0, 0, 1, 1, 1}).load().report.ignored,
              ElementsAre(IsErrorAt("/animations/0", "cannot be played")));
  AnimationBuilder missing = broken({0, 1}, {0, 0, 0, 1, 1, 1});
  missing.root["animations"][0]["channels"][0]["sampler"] = 4;
  expectError(missing, "/animations/0/channels/0/sampler", "sampler 4");
}

TEST(GltfAnimations, StructureIsCheckedAlways) {
  AnimationBuilder builder = movingTriangle();
  builder.addChannel(1, "translation", {0, 1}, {0, 0, 0, 3, 0, 0});
  Json& animation = builder.root["animations"][0];
  const AnimationBuilder valid = builder;
  animation["channels"][0]["target"]["node"] = 7;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/animations/0/channels/0/target/node", "node 7"));
  builder = valid;
  builder.root["animations"][0]["samplers"][0]["input"] = 70;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/animations/0/samplers/0/input", "accessor 70"));
  builder = valid;
  builder.root["animations"][0]["samplers"][0]["interpolation"] = "BEZIER";
  EXPECT_THAT(errorOf(builder), IsErrorAt("/animations/0/samplers/0/interpolation", "BEZIER"));
}

TEST(GltfAnimations, RotationsAndWeightsCanBeIntegers) {
  AnimationBuilder builder = morphingTriangle();
  builder.root["animations"][0]["samplers"][0]["output"] =
      builder.addAccessor<std::uint8_t>({0, 0, 255, 0, 0, 51}, "SCALAR", true);
  builder.addChannel(0, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 0, 1});
  builder.root["animations"][0]["samplers"][1]["output"] =
      builder.addAccessor<std::int16_t>({0, 0, 0, 32767, 0, 0, 32767, 0}, "VEC4", true);
  const scene::NodeAnimation animation = *builder.loadAnimated().nodeAnimation;
  EXPECT_THAT(animation.animation.samplers[0].values, ElementsAre(0, 0, 1, 0, 0, 0.2f));
  EXPECT_THAT(animation.animation.samplers[1].values, ElementsAre(0, 0, 0, 1, 0, 0, 1, 0));
}

TEST(GltfAnimations, InstancesOfGpuInstancingFollowTheirNode) {
  AnimationBuilder builder = movingTriangle();
  builder.root["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  builder.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      builder.addAccessor<float>({0, 1, 0, 0, 2, 0}, "VEC3");
  builder.addChannel(1, "scale", {0, 1}, {1, 1, 1, 3, 3, 3});
  scene::Scene scene = builder.loadAnimated();
  ASSERT_EQ(scene.instances.size(), 2u);
  scene::applyPose(scene, scene::poseAt(scene.nodeAnimation.get(), 24));
  EXPECT_LT(glm::distance(vec3(scene.instances[1].worldFromObject[3]), vec3(1, 6, 0)), 1e-5f);
}

}  // namespace
}  // namespace quintet::test
