// SPDX-License-Identifier: Apache-2.0
// The features of a scene are known before its images are decoded.
#include "render/scene/scene_features.h"

#include <gtest/gtest.h>

#include "base/file.h"
#include "io/codec.h"
#include "scene/defaults/default_environment.h"
#include "scene/gltf_builder.h"
#include "scene/load.h"

namespace quintet::test {
namespace {

// A triangle whose material blends by the alpha of an image with this number of channels.
std::vector<std::byte> veil(std::uint32_t channels) {
  GltfBuilder builder;
  const io::Image image = io::makeImage(4, 4, channels, io::PixelType::u8, io::ColorEncoding::sRgb);
  builder.add("images", {{"bufferView", builder.addView(io::encodePng(image))}, {"mimeType", "image/png"}});
  builder.add("textures", {{"source", 0}});
  builder.add("materials", {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  const int positions = builder.addAccessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  builder.root["accessors"][static_cast<std::size_t>(positions)]["min"] = {0, 0, 0};
  builder.root["accessors"][static_cast<std::size_t>(positions)]["max"] = {1, 1, 0};
  builder.addMesh({{"attributes", {{"POSITION", positions}}}, {"material", 0}});
  return builder.glb();
}

TEST(SceneFeatures, AreKnownBeforeImagesAreDecoded) {
  const TempFolder folder;
  for (const std::uint32_t channels : {3u, 4u}) {
    writeFile(folder / "veil.glb", veil(channels));
    scene::PendingScene pending = scene::beginLoading(folder / "veil.glb");
    ASSERT_TRUE(pending.described());
    EXPECT_TRUE(pending.scene().images.at(0).image.empty());
    const render::SceneFeatures early =
        render::sceneFeatures(pending.scene(), scene::effectiveEnvironment(pending.scene()));
    const scene::Scene scene = std::move(pending).finish();
    const render::SceneFeatures late = render::sceneFeatures(scene, scene::effectiveEnvironment(scene));
    EXPECT_EQ(early, late);
    EXPECT_EQ(late.alpha, channels == 4);
    gpu::Quirks quirks;
    EXPECT_EQ(render::shaderDefines(late, quirks), late.defines);
    quirks.corruptsHitAttributes = true;
    EXPECT_EQ(render::shaderDefines(late, quirks).size(), late.defines.size() + (channels == 4 ? 2 : 1));
  }
}

}  // namespace
}  // namespace quintet::test
