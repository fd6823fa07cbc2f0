// SPDX-License-Identifier: Apache-2.0
// The built-in scene is valid, faces outwards and is in front of its camera.
#include "scene/defaults/default_scene.h"

#include <gtest/gtest.h>

#include "scene/model/validate.h"

namespace quintet::scene {
namespace {

TEST(DefaultScene, IsValid) {
  for (const DefaultSceneOptions options : {DefaultSceneOptions{true, false}, DefaultSceneOptions{true, true}}) {
    const Scene scene = defaultScene(options);
    EXPECT_NO_THROW(validate(scene));
    EXPECT_EQ(scene.cameras.size(), 1u);
    EXPECT_FALSE(scene.instances.empty());
  }
}

// Every triangle is counter-clockwise seen from the side of its normals.
TEST(DefaultScene, WindingMatchesNormals) {
  for (const Mesh& mesh : defaultScene().meshes) {
    for (const Geometry& geometry : mesh.geometries) {
      ASSERT_EQ(geometry.normals.size(), geometry.positions.size());
      for (const uvec3& t : geometry.triangles) {
        const vec3 a = geometry.positions[t.x], b = geometry.positions[t.y], c = geometry.positions[t.z];
        const vec3 normal = geometry.normals[t.x] + geometry.normals[t.y] + geometry.normals[t.z];
        EXPECT_GT(glm::dot(glm::cross(b - a, c - a), normal), 0.0f) << mesh.name;
      }
    }
  }
}

TEST(DefaultScene, ContainsOnlyBoxesOnRequest) {
  const Scene scene = defaultScene({false, true});
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_TRUE(scene.meshes[0].procedural());
  EXPECT_EQ(boxCount(scene.meshes[0].primitiveSets[0]), 1u);
}

TEST(DefaultScene, IsInFrontOfTheCamera) {
  const Scene scene = defaultScene();
  const mat4 cameraFromWorld = glm::inverse(scene.cameras[0].worldFromCamera);
  for (const Instance& instance : scene.instances)
    EXPECT_LT((cameraFromWorld * instance.worldFromObject[3]).z, 0.0f) << instance.name;
}

}  // namespace
}  // namespace quintet::scene
