// SPDX-License-Identifier: Apache-2.0
// Which solids are around a point (render/scene/camera_media.h).
#include <gtest/gtest.h>

#include "harness.h"
#include "render/scene/device_scene.h"
#include "scene_builder.h"

namespace quintet::test {
namespace {

using render::Media;

render::DeviceScene onDevice(const SceneBuilder& scene) {
  return {testContext(), scene::Scene(scene.scene), scene.environment, {.editable = true}};
}

scene::Instance placed(int mesh, const mat4& worldFromObject) {
  scene::Instance instance;
  instance.mesh = mesh;
  instance.worldFromObject = worldFromObject;
  return instance;
}

TEST(CameraMedia, ListsTheSolidsFromTheInsideOut) {
  SceneBuilder scene;
  scene.add(sphere(vec3(0.0f), 2.0f, 2), clearGlass(1.3f, 1.0f))
      .add(box(vec3(-0.5f), vec3(0.5f)), clearGlass(1.5f, 1.0f))
      .add(box(vec3(-1.0f), vec3(1.0f)), lambert(vec3(0.5f)))      // opaque
      .add(box(vec3(-1.0f), vec3(1.0f)), clearGlass(1.5f, 0.0f));  // a thin wall
  render::DeviceScene device = onDevice(scene);
  EXPECT_EQ(device.mediaAt(vec3(0.1f)), (Media{2, 1}));
  EXPECT_EQ(device.mediaAt(vec3(0.8f)), (Media{1}));
  EXPECT_EQ(device.mediaAt(vec3(1.9f)), (Media{}));  // in the bounding box of the sphere
  EXPECT_EQ(device.mediaAt(vec3(9.0f)), (Media{}));
}

TEST(CameraMedia, FollowsTheTransformsOfInstances) {
  SceneBuilder scene;
  scene.add(box(vec3(-1.0f), vec3(1.0f)), clearGlass(1.5f, 1.0f));
  const mat4 mirrored = glm::scale(glm::translate(mat4(1.0f), vec3(5, 0, 0)), vec3(-0.5f, 1, 1));
  scene.scene.instances = {placed(0, mirrored), placed(0, glm::translate(mat4(1.0f), vec3(0, 9, 0)))};
  scene.scene.instances[1].mask = 0;  // rays do not hit it
  render::DeviceScene device = onDevice(scene);
  EXPECT_EQ(device.mediaAt({5.4f, 0, 0}), (Media{1}));
  EXPECT_EQ(device.mediaAt({5.6f, 0, 0}), (Media{}));
  EXPECT_EQ(device.mediaAt({0, 9, 0}), (Media{}));
  device.setTransforms(std::vector<render::InstanceTransform>{{.instance = 0}});
  EXPECT_EQ(device.mediaAt({0.9f, 0, 0}), (Media{1}));
}

// A box without lid: the winding number is above 1/2 near the bottom.
TEST(CameraMedia, AcceptsMeshesWithHoles) {
  SceneBuilder scene;
  scene::Geometry bowl = box(vec3(-1.0f), vec3(1.0f));
  std::erase_if(bowl.triangles, [&](const uvec3& t) {
    return bowl.positions[t.x].y > 0 && bowl.positions[t.y].y > 0 && bowl.positions[t.z].y > 0;
  });
  ASSERT_EQ(bowl.triangles.size(), 10u);
  render::DeviceScene device = onDevice(scene.add(bowl, clearGlass(1.5f, 1.0f)));
  EXPECT_EQ(device.mediaAt({0, -0.5f, 0}), (Media{1}));
  EXPECT_EQ(device.mediaAt({0, 1.5f, 0}), (Media{}));
  EXPECT_EQ(device.mediaAt({0, -1.5f, 0}), (Media{}));
}

// Each part of a mesh that overlaps counts, because rays leave each of them. Geometries with one material bound one solid.
TEST(CameraMedia, CountsThePartsOfAMesh) {
  SceneBuilder scene;
  scene.add(box(vec3(-1.0f), vec3(1.0f)), clearGlass(1.5f, 1.0f));
  std::vector<scene::Geometry>& parts = scene.scene.meshes[0].geometries;
  parts.push_back(parts[0]);
  for (vec3& p : parts[1].positions) p.x += 1.0f;
  const auto half = parts[0].triangles.begin() + 6;
  parts.push_back(parts[0]);
  parts[2].triangles.assign(parts[0].triangles.begin(), half);
  parts[0].triangles.erase(parts[0].triangles.begin(), half);
  render::DeviceScene device = onDevice(scene);
  EXPECT_EQ(device.mediaAt({0.5f, 0, 0}), (Media{1, 1}));
  EXPECT_EQ(device.mediaAt({-0.5f, 0, 0}), (Media{1}));
  EXPECT_EQ(device.mediaAt({1.5f, 0, 0}), (Media{1}));
}

TEST(CameraMedia, FollowsEditsOfMaterials) {
  SceneBuilder scene;
  scene.add(box(vec3(-1.0f), vec3(1.0f)), lambert(vec3(0.5f))).add(box(vec3(8.0f), vec3(9.0f)), clearGlass(1.5f, 1.0f));
  render::DeviceScene device = onDevice(scene);
  EXPECT_EQ(device.mediaAt(vec3(0.0f)), (Media{}));
  ASSERT_TRUE(device.setMaterial(0, clearGlass(1.5f, 1.0f)));
  EXPECT_EQ(device.mediaAt(vec3(0.0f)), (Media{1}));
}

// Analytic solids, and a CSG tree: a ball without a smaller one.
TEST(CameraMedia, FindsSolidsAndTrees) {
  SceneBuilder scene;
  scene.scene.materials = {clearGlass(1.5f, 1.0f), clearGlass(1.3f, 1.0f)};
  scene::PrimitiveSet solids, trees;
  solids.primitives = {{.type = scene::PrimitiveType::cylinder, .material = 0}};
  trees.kind = scene::PrimitiveSetKind::csg;
  trees.primitives = {{.objectFromPrimitive = glm::scale(mat4(1.0f), vec3(4.0f)), .material = 1},
                      {.objectFromPrimitive = glm::scale(mat4(1.0f), vec3(2.0f)), .material = 0}};
  trees.nodes = {{.primitive = 0}, {.primitive = 1}, {.operation = scene::CsgOperation::subtract}};
  trees.trees = {{.firstNode = 0, .nodeCount = 3}};
  for (const auto& set : {solids, trees}) {
    scene.scene.instances.push_back(placed(static_cast<int>(scene.scene.meshes.size()), mat4(1.0f)));
    scene.scene.meshes.emplace_back().primitiveSets.push_back(set);
  }
  render::DeviceScene device = onDevice(scene);
  EXPECT_EQ(device.mediaAt({0.9f, 0.9f, 0}), (Media{1}));
  EXPECT_EQ(device.mediaAt({0.9f, 1.1f, 0}), (Media{}));
  EXPECT_EQ(device.mediaAt({0, 3, 0}), (Media{2}));
}

}  // namespace
}  // namespace quintet::test
