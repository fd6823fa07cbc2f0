// SPDX-License-Identifier: Apache-2.0
// The limit on the memory that a scene file requests: LoadOptions::maxMemory.
#include <gmock/gmock.h>

#include <fstream>

#include "base/error.h"
#include "base/file.h"
#include "scene/error_matcher.h"
#include "scene/gltf/gltf.h"
#include "scene/gltf_builder.h"
#include "scene/toml/scene_toml.h"

namespace quintet::test {
namespace {

// A line of JSON that requests more memory than any machine has. The request is counted before anything is read.
TEST(SceneMemory, RejectsExcessiveAccessors) {
  GltfBuilder builder;
  builder.addTriangle();
  const Json primitive = {
      {"attributes", {{"POSITION", 0}}},
      {"indices",
       builder.add("accessors", {{"componentType", kUnsignedInt}, {"count", 4294967295u}, {"type", "SCALAR"}})}};
  builder.root["meshes"][0]["primitives"] = Json::array_t(1000, primitive);
  EXPECT_THROW(builder.load(), Error);
}

std::string errorWithin(const GltfBuilder& builder, std::size_t bytes) {
  const TempFolder folder;
  writeFile(folder / "a.glb", builder.glb());
  try {
    scene::loadGltf(folder / "a.glb", {.maxMemory = bytes});
  } catch (const MemoryError& error) {
    return error.what();
  }
  return "";
}

// Each of these files states a size that its bytes cannot fill. The size counts before it is allocated.
TEST(SceneMemory, CountsStatedSizes) {
  constexpr std::size_t kLimit = std::size_t{1} << 20;
  GltfBuilder plain;
  plain.addTriangle();
  EXPECT_EQ(errorWithin(plain, kLimit), "");

  GltfBuilder instances = plain;
  const int zeros = instances.add("accessors", {{"componentType", kFloat}, {"count", 1 << 20}, {"type", "VEC3"}});
  instances.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = zeros;

  GltfBuilder targets = plain;
  const int unbacked = targets.add("accessors", {{"componentType", kFloat}, {"count", 1 << 20}, {"type", "VEC3"}});
  targets.primitive()["targets"] = {{{"POSITION", unbacked}}};

  GltfBuilder meshopt = plain;
  const int view = meshopt.addView(std::vector<std::uint8_t>(1 << 14, 0xA0));
  meshopt.root["bufferViews"][1]["byteLength"] = 1 << 21;
  meshopt.root["bufferViews"][1]["extensions"]["EXT_meshopt_compression"] = {
      {"buffer", 0}, {"byteLength", 1 << 14}, {"byteStride", 4}, {"count", 1 << 19}, {"mode", "ATTRIBUTES"}};
  EXPECT_EQ(view, 1);

  GltfBuilder image = plain;
  const std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 4096\n";
  image.add("images",
            {{"bufferView", image.addView(std::vector<char>(hdr.begin(), hdr.end()))}, {"mimeType", "image/png"}});
  image.add("textures", {{"source", 0}});
  image.add("materials", {{"emissiveTexture", {{"index", 0}}}});

  GltfBuilder json = plain;
  json.root["extras"] = std::vector<int>(40000, 0);

  for (const GltfBuilder* builder : {&instances, &targets, &meshopt, &image, &json})
    EXPECT_THAT(errorWithin(*builder, kLimit), testing::HasSubstr("1.0 MiB")) << builder->json().substr(0, 300);
}

// The header of the image states 192 MiB of pixels, which do not follow.
TEST(SceneMemory, CountsImagesOfSceneFiles) {
  const TempFolder folder;
  std::ofstream(folder / "a.hdr") << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 4096\n";
  for (const char* text :
       {"[environment]\nimage = 'a.hdr'\n", "[[material]]\nname = 'm'\nemissive_texture = { image = 'a.hdr' }\n"})
    try {
      scene::parseSceneToml(text, folder / "s.scene.toml", {.maxMemory = std::size_t{1} << 20});
      ADD_FAILURE() << text;
    } catch (const MemoryError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("1.0 MiB"));
    }
}

// Values of two bytes become objects of TOML.
TEST(SceneMemory, CountsTheTextOfSceneFiles) {
  const TempFolder folder;
  std::string text = "[[mesh]]\nname = 'm'\npositions = [";
  for (int i = 0; i < 10'000; ++i) text += "0,";
  text += "]\n";
  EXPECT_THROW(scene::parseSceneToml(text, folder / "s.scene.toml", {.maxMemory = std::size_t{1} << 20}), MemoryError);
}

// All files of a scene share one limit.
TEST(SceneMemory, IsSharedByTheFilesOfAScene) {
  GltfBuilder builder;
  builder.addTriangle();
  const TempFolder folder;
  writeFile(folder / "a.glb", builder.glb());
  std::string text;
  for (int i = 0; i < 20; ++i) text += "[[file]]\nname = 'f" + std::to_string(i) + "'\npath = 'a.glb'\n";
  const std::size_t enough = 20 * 32 * builder.glb().size();
  EXPECT_NO_THROW(scene::parseSceneToml(text, folder / "s.scene.toml", {.maxMemory = enough}));
  EXPECT_THROW(scene::parseSceneToml(text, folder / "s.scene.toml", {.maxMemory = enough / 8}), MemoryError);
}

TEST(SceneMemory, LimitsTheNumberOfInstances) {
  GltfBuilder builder;
  builder.addTriangle();
  const int zeros = builder.add("accessors", {{"componentType", kFloat}, {"count", 1 << 24}, {"type", "VEC3"}});
  builder.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = zeros;
  EXPECT_THAT(errorOf(builder),
              IsErrorAt("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes", "16777215 instances"));
}

}  // namespace
}  // namespace quintet::test
