// SPDX-License-Identifier: Apache-2.0
// Poses of small animated files against values computed by hand.
#include "scene/animation/pose.h"

#include <gtest/gtest.h>

#include "scene/animation/animated_bounds.h"
#include "scene/gltf_animation.h"

namespace quintet::test {
namespace {

scene::Scene posed(scene::Scene scene, double frame) {
  scene::applyPose(scene, scene::poseAt(scene.nodeAnimation.get(), frame));
  return scene;
}

void expectNear(const vec3& actual, const vec3& expected) {
  EXPECT_LT(glm::distance(actual, expected), 1e-5f) << actual.x << " " << actual.y << " " << actual.z << ", expected "
                                                    << expected.x << " " << expected.y << " " << expected.z;
}

TEST(Pose, NodesMoveInstancesBelowThem) {
  AnimationBuilder builder = movingTriangle();
  builder.addChannel(1, "translation", {0, 1}, {1, 0, 0, 3, 0, 0});
  builder.addChannel(1, "scale", {0, 1}, {1, 1, 1, 2, 2, 2});
  builder.root["nodes"][0]["translation"] = {0, 5, 0};
  const scene::Scene scene = builder.loadAnimated();
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].node, 0);
  // Frame 12 of 24 per second: the parent is at x = 2 with a scale of 1.5.
  const mat4 half = scene::worldFromObjectAt(scene.instances[0], scene::poseAt(scene.nodeAnimation.get(), 12));
  expectNear(vec3(half * vec4(0, 0, 0, 1)), {2, 7.5f, 0});
  expectNear(vec3(half * vec4(1, 0, 0, 1)), {3.5f, 7.5f, 0});
  expectNear(vec3(posed(scene, 1000).instances[0].worldFromObject[3]), {3, 10, 0});
}

TEST(Pose, TimeIsFramesDividedByTheRate) {
  AnimationBuilder builder = movingTriangle();
  builder.addChannel(1, "translation", {0, 1}, {0, 0, 0, 60, 0, 0});
  expectNear(vec3(posed(builder.loadAnimated("", 60), 7).instances[0].worldFromObject[3]), {7, 0, 0});
  expectNear(vec3(posed(builder.loadAnimated("", 30), 7).instances[0].worldFromObject[3]), {14, 0, 0});
}

TEST(Pose, RestPoseHasNoAnimation) {
  AnimationBuilder builder = movingTriangle();
  builder.addChannel(1, "translation", {0, 1}, {7, 0, 0, 3, 0, 0});
  const scene::Scene rest = builder.loadAnimated(std::nullopt);
  EXPECT_EQ(rest.nodeAnimation, nullptr);
  EXPECT_EQ(rest.instances[0].node, scene::kNone);
  expectNear(vec3(rest.instances[0].worldFromObject[3]), {1, 0, 0});
  expectNear(vec3(builder.loadAnimated().instances[0].worldFromObject[3]), {7, 0, 0});  // frame 0
}

TEST(Pose, JointsBendASkin) {
  for (const std::size_t sets : {1u, 2u, 3u}) {
    const scene::Scene scene = posed(bendingStrip(sets).loadAnimated(), 24);
    EXPECT_EQ(scene.instances[0].worldFromObject, mat4(1.0f));
    const scene::Geometry& geometry = scene.meshes[0].geometries[0];
    ASSERT_EQ(geometry.positions.size(), 6u);
    expectNear(geometry.positions[0], {0, 0, 0});
    expectNear(geometry.positions[1], {1, 0, 0});
    expectNear(geometry.positions[4], {-1, 1, 0});  // (0,2) turned by 90° about (0,1)
    expectNear(geometry.positions[5], {-1, 2, 0});
    // Half of each: (1,1) stays (1,1) with joint 0 and becomes (0,2) with joint 1.
    expectNear(geometry.positions[3], {0.5f, 1.5f, 0});
    expectNear(geometry.normals[5], {0, 0, 1});
  }
}

TEST(Pose, WeightsMorphPositionsAndNormals) {
  const scene::Scene scene = morphingTriangle().loadAnimated();
  const scene::Geometry start = scene.meshes[0].geometries[0];  // frame 0, not the rest pose
  expectNear(start.positions[2], {0, 1, 0});
  expectNear(start.normals[2], {0, 0, 1});
  const scene::Geometry first = posed(scene, 24).meshes[0].geometries[0];
  expectNear(first.positions[2], {0, 1, 1});
  expectNear(first.normals[2], glm::normalize(vec3(1, 0, 1)));
  const scene::Geometry between = posed(scene, 36).meshes[0].geometries[0];  // half of both targets
  expectNear(between.positions[2], {0, 2, 0.5f});
  expectNear(between.normals[0], glm::normalize(vec3(0.5f, 0, 1)));
  EXPECT_EQ(scene.instances[0].node, scene::kNone) << "the node itself does not move";
}

// The same mesh in an animated and in a static node, which has the rest weights.
TEST(Pose, OnlyTheMeshOfTheAnimatedNodeDeforms) {
  AnimationBuilder builder = morphingTriangle();
  builder.add("nodes", {{"mesh", 0}});
  const scene::Scene scene = posed(builder.loadAnimated(), 48);
  ASSERT_EQ(scene.instances.size(), 2u);
  const auto apex = [&](std::size_t i) {
    return scene.meshes[static_cast<std::size_t>(scene.instances[i].mesh)].geometries[0].positions[2];
  };
  expectNear(apex(0), {0, 3, 0});
  expectNear(apex(1), {0, 1, 0.5f});
  EXPECT_EQ(scene.meshes[static_cast<std::size_t>(scene.instances[1].mesh)].deformation, nullptr);
}

TEST(Pose, CamerasAndLightsFollowTheirNodes) {
  AnimationBuilder builder = movingTriangle();
  builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}, {"spot", Json::object()}}};
  builder.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
  builder.root["nodes"][1]["camera"] = 0;
  builder.root["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  const float half = std::sqrt(0.5f);
  builder.addChannel(1, "rotation", {0, 1}, {0, 0, 0, 1, 0, half, 0, half});  // 90° about y
  builder.addChannel(1, "translation", {0, 1}, {0, 0, 0, 0, 4, 0});
  const scene::Scene scene = posed(builder.loadAnimated(), 24);
  expectNear(vec3(scene.cameras.at(0).worldFromCamera[3]), {0, 4, 0});
  expectNear(-vec3(scene.cameras[0].worldFromCamera[2]), {-1, 0, 0});
  expectNear(scene.lights.at(0).position, {0, 4, 0});
  expectNear(scene.lights[0].direction, {-1, 0, 0});
}

// A vertex that two triangles of different handedness share is split for tangents: skins and targets follow.
TEST(Pose, SplitVerticesKeepTheirSkin) {
  AnimationBuilder builder = bendingStrip();
  // The upper quad mirrors the texture of the lower one.
  builder.primitive()["attributes"]["TEXCOORD_0"] =
      builder.addAccessor<float>({0, 1, 1, 1, 0, 0, 1, 0, 0, 1, 1, 1}, "VEC2");
  builder.add("images", {{"bufferView", builder.addView(tinyPng())}, {"mimeType", "image/png"}});
  builder.add("textures", {{"source", 0}});
  builder.add("materials", {{"normalTexture", {{"index", 0}}}});
  builder.primitive()["material"] = 0;
  const scene::Scene scene = posed(builder.loadAnimated(), 24);
  const scene::Geometry& geometry = scene.meshes[0].geometries[0];
  ASSERT_EQ(geometry.positions.size(), 8u);
  ASSERT_EQ(geometry.tangents.size(), 8u);
  EXPECT_EQ(geometry.fileVertices.size(), 0u);
  for (const uvec3& triangle : geometry.triangles)  // the corners of the upper quad, of which two are copies
    for (std::size_t c = 0; c < 3; ++c) EXPECT_LT(triangle[c], 8u);
  expectNear(geometry.positions[geometry.triangles[2].x], {-0.5f + 0.5f, 1.0f, 0});  // a copy of vertex 2, halfway
  expectNear(vec3(geometry.tangents[5]), {0, 1, 0});                                 // u of the upper quad, turned
  expectNear(vec3(geometry.tangents[0]), {1, 0, 0});
}

TEST(Pose, FlatShadedGeometryKeepsFaceNormals) {
  AnimationBuilder builder = bendingStrip();
  Json& attributes = builder.primitive()["attributes"];
  attributes.erase("NORMAL");
  EXPECT_TRUE(builder.loadAnimated().meshes[0].geometries[0].normals.empty());
  // A normal map requires tangents, and thus normals.
  builder.add("images", {{"bufferView", builder.addView(tinyPng())}, {"mimeType", "image/png"}});
  builder.add("textures", {{"source", 0}});
  builder.add("materials", {{"normalTexture", {{"index", 0}}}});
  builder.primitive()["material"] = 0;
  builder.root["animations"][0]["channels"][0]["target"]["node"] = 2;
  builder.addChannel(1, "rotation", {0, 1}, {0, 0, 0, 1, 1, 0, 0, 0});  // half a turn about x: faces turn over
  const scene::Scene scene = posed(builder.loadAnimated(), 24);
  const scene::Geometry& geometry = scene.meshes[0].geometries[0];
  ASSERT_EQ(geometry.normals.size(), 12u);
  for (const vec3& normal : geometry.normals) expectNear(normal, {0, 0, -1});
}

TEST(Pose, BoundsCoverTheWholeAnimation) {
  AnimationBuilder builder = movingTriangle();
  builder.addChannel(1, "translation", {0, 1, 2}, {0, 0, 0, 5, 0, 0, 0, 0, 0});
  Bounds3 bounds = scene::animatedBounds(builder.loadAnimated());
  expectNear(bounds.min, {0, 0, 0});
  expectNear(bounds.max, {6, 1, 0});
  bounds = scene::animatedBounds(bendingStrip().loadAnimated());
  EXPECT_NEAR(bounds.min.x, -1, 1e-5f);
  EXPECT_NEAR(bounds.max.y, std::sqrt(2.0f) + 1.0f, 0.01f) << "the corner passes above the joint";
  EXPECT_EQ(scene::animatedBounds(movingTriangle().load()).max.x, 2);
}

TEST(Pose, PositionsStayFinite) {
  AnimationBuilder builder = morphingTriangle();
  builder.root["animations"][0]["samplers"][0]["output"] =
      builder.addAccessor<float>({0, 0, 3e38f, 3e38f, 0, 1}, "SCALAR");
  const scene::Geometry geometry = posed(builder.loadAnimated(), 24).meshes[0].geometries[0];
  for (const vec3& p : geometry.positions) EXPECT_TRUE(isFinite(p));
  for (const vec3& n : geometry.normals) EXPECT_NEAR(glm::length(n), 1.0f, 1e-5f);
}

}  // namespace
}  // namespace quintet::test
