// SPDX-License-Identifier: Apache-2.0
// Loading of scene files of any format, in one step and in two.
#include "scene/load.h"

#include <gtest/gtest.h>

#include <optional>
#include <string_view>

#include "base/error.h"
#include "base/file.h"
#include "scene/gltf_builder.h"
#include "scene/model/content_hash.h"
#include "temp_folder.h"

namespace quintet::test {
namespace {

// A triangle with a textured material.
std::vector<std::byte> texturedGlb() {
  GltfBuilder builder;
  builder.addTriangle();
  builder.add("images", {{"bufferView", builder.addView(tinyPng())}, {"mimeType", "image/png"}});
  builder.add("textures", {{"source", 0}});
  builder.add("materials", {{"emissiveTexture", {{"index", 0}}}});
  builder.primitive()["material"] = 0;
  return builder.glb();
}

TEST(LoadScene, DetectsTheFormatByNameOrContent) {
  const TempFolder folder;
  writeFile(folder / "a.scene.toml", std::string_view("[[mesh]]\nshape = 'quad'\n"));
  writeFile(folder / "b.txt", std::string_view("  # a scene\n[[mesh]]\nshape = 'quad'\n"));
  writeFile(folder / "c.txt", std::string_view("some text"));
  EXPECT_EQ(scene::loadScene(folder / "a.scene.toml").meshes.size(), 1u);
  EXPECT_EQ(scene::loadScene(folder / "b.txt").meshes.size(), 1u);
  EXPECT_EQ(scene::contentHash(scene::loadScene(folder / "a.scene.toml")),
            scene::contentHash(scene::loadScene(folder / "b.txt")));
  EXPECT_THROW(scene::loadScene(folder / "c.txt"), FileError);
  EXPECT_THROW(scene::loadScene(folder / "none.toml"), FileError);
}

TEST(BeginLoading, ReturnsGltfWithoutImageData) {
  const TempFolder folder;
  writeFile(folder / "scene.glb", texturedGlb());
  scene::PendingScene pending = scene::beginLoading(folder / "scene.glb");
  EXPECT_TRUE(pending.described());
  EXPECT_EQ(pending.scene().instances.size(), 1u);
  EXPECT_EQ(pending.scene().images.at(0).image.width, 2u);
  EXPECT_TRUE(pending.scene().images.at(0).image.data.empty());
  const scene::Scene scene = std::move(pending).finish();
  EXPECT_EQ(scene.images.at(0).image.data.size(), 12u);
  EXPECT_EQ(scene::contentHash(scene), scene::contentHash(scene::loadScene(folder / "scene.glb")));
}

// The second step does not depend on the object that the first one returned.
TEST(BeginLoading, ReturnsAMovableValue) {
  const TempFolder folder;
  writeFile(folder / "scene.glb", texturedGlb());
  std::optional<scene::PendingScene> first = scene::beginLoading(folder / "scene.glb");
  scene::PendingScene second = std::move(*first);
  first.reset();
  std::filesystem::remove(folder / "scene.glb");
  EXPECT_EQ(std::move(second).finish().images.at(0).image.data.size(), 12u);
}

TEST(BeginLoading, ReadsTomlCompletely) {
  const TempFolder folder;
  writeFile(folder / "p.png", tinyPng());
  writeFile(folder / "a.scene.toml",
            std::string_view("[[material]]\nname = 'm'\nbase_color_texture = 'p.png'\n[[mesh]]\nshape = 'quad'\n"));
  scene::PendingScene pending = scene::beginLoading(folder / "a.scene.toml");
  EXPECT_TRUE(pending.described());
  EXPECT_EQ(pending.scene().images.at(0).image.data.size(), 12u);
  EXPECT_EQ(std::move(pending).finish().meshes.size(), 1u);
}

}  // namespace
}  // namespace quintet::test
