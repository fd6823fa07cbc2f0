// SPDX-License-Identifier: Apache-2.0
// Which names are scene files.
#include "job/scene_source.h"

#include <gtest/gtest.h>

namespace quintet::job {
namespace {

TEST(SceneSource, ScenesHaveTheExtensionsThatLoad) {
  for (const char* name : {"a.gltf", "a.GLB", "folder/a.glTF", "a.scene.toml", "a.toml", "a.Toml"})
    EXPECT_TRUE(isSceneFile(name)) << name;
  for (const char* name : {"ao", "a.rt.glsl", "program.toml", "folder/program.toml", "glb", "a.glb/"})
    EXPECT_FALSE(isSceneFile(name)) << name;
}

}  // namespace
}  // namespace quintet::job
