// SPDX-License-Identifier: Apache-2.0
// The features of a scene: they are known before its images are decoded, and state what its shaders can leave out.
#include "render/scene/scene_features.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "base/file.h"
#include "io/codec.h"
#include "render/lights/light_table.h"
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
  const int uvs = builder.addAccessor(std::vector<float>{0, 0, 1, 0, 0, 1}, "VEC2");
  builder.addMesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}}, {"material", 0}});
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

// On a CPU, scenes share variants of the shaders, which take long to compile.
TEST(SceneFeatures, OfTexturesAndColorsMatterOnGpusOnly) {
  scene::Scene plain, textured;
  for (scene::Scene* scene : {&plain, &textured}) {
    scene->materials.emplace_back();
    scene->meshes.emplace_back().geometries.emplace_back();
  }
  textured.meshes[0].geometries[0].colors.resize(3);
  textured.materials[0].baseColorTexture.texture = 0;
  const auto defines = [](const scene::Scene& scene, const gpu::Quirks& quirks) {
    return render::shaderDefines(render::sceneFeatures(scene, {}), quirks);
  };
  gpu::Quirks cpu;
  cpu.slowInstances = true;
  EXPECT_NE(defines(plain, {}), defines(textured, {}));
  EXPECT_EQ(defines(plain, cpu), defines(textured, cpu));
  textured.materials[0].clearcoat = 1;
  EXPECT_NE(defines(plain, cpu), defines(textured, cpu));
}

// The tree can only be left out if the table of lights, which the tree holds, has at most one.
TEST(SceneFeatures, HaveALightTreeForSeveralLights) {
  scene::Environment sky;
  sky.constant = vec3(0.3f);
  scene::Environment dark = sky;
  dark.intensity = 0.0f;
  const auto lit = [](std::size_t lights, const vec3& emission) {
    scene::Scene scene;
    scene.lights.resize(lights);
    for (scene::Light& light : scene.lights) light.intensity = vec3(2.0f);
    scene::Geometry geometry;
    geometry.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    geometry.triangles = {{0, 1, 2}, {0, 2, 3}};
    geometry.material = 0;
    scene.materials.emplace_back().emissive = emission;
    scene.meshes.emplace_back().geometries = {geometry};
    scene.instances.emplace_back().mesh = 0;
    return scene;
  };
  for (const std::size_t lights : {0u, 1u, 2u})
    for (const vec3& emission : {vec3(0.0f), vec3(1.0f)})
      for (const scene::Environment& environment : {scene::Environment{}, dark, sky}) {
        const scene::Scene scene = lit(lights, emission);
        const std::size_t count = render::buildLightTable(scene, environment).lights.size();
        const bool without = std::ranges::count(render::sceneFeatures(scene, environment).defines,
                                                render::Defines::value_type{"QUINTET_NO_LIGHT_TREE", "1"}) > 0;
        EXPECT_EQ(without, count <= 1) << lights << " lights, emission " << emission.x << ", environment "
                                       << environment.constant.x << " x " << environment.intensity;
      }
}

}  // namespace
}  // namespace quintet::test
