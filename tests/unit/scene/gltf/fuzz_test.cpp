// SPDX-License-Identifier: Apache-2.0
// Deterministic mutations of one file that uses all features. Every result loads or throws an Error. Most useful under
// -DQUINTET_SANITIZE=address,undefined.
#include <gtest/gtest.h>

#include <random>

#include "base/error.h"
#include "scene/gltf_samples.h"

namespace quintet::test {
namespace {

// Loads and validates the file. An Error is accepted if its message is one line.
void survive(const std::vector<std::byte>& file, const std::string& what) {
  SCOPED_TRACE(what);
  try {
    loadBytes(file);
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_FALSE(message.empty());
    for (const char c : message) EXPECT_FALSE(c >= 0 && c < ' ') << message;
  }
}

TEST(GltfFuzz, LoadsTheOriginal) {
  const scene::Scene scene = sceneWithEverything().load();
  EXPECT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.lights.size(), 1u);
  EXPECT_EQ(scene.cameras.size(), 1u);
}

TEST(GltfFuzz, SurvivesTruncation) {
  const auto glb = sceneWithEverything().glb();
  for (std::size_t size = 0; size < glb.size(); size += 7) {
    auto file = glb;
    file.resize(size);
    if (size >= 12)  // adapts the stated length, so that the error is found further inside
      for (std::size_t i = 0; i < 4; ++i) file[8 + i] = static_cast<std::byte>(size >> (8 * i) & 0xFF);
    survive(file, "truncated to " + std::to_string(size));
  }
}

TEST(GltfFuzz, SurvivesReplacedBytes) {
  const auto glb = sceneWithEverything().glb();
  std::mt19937 random(1);
  for (int round = 0; round < 1500; ++round) {
    auto file = glb;
    const int flips = 1 + static_cast<int>(random() % 4);
    for (int i = 0; i < flips; ++i) file[random() % file.size()] = static_cast<std::byte>(random() & 0xFF);
    survive(file, "round " + std::to_string(round));
  }
}

TEST(GltfFuzz, SurvivesReplacedBinaryData) {
  const GltfBuilder original = sceneWithEverything();
  std::mt19937 random(2);
  for (int round = 0; round < 1000; ++round) {
    GltfBuilder broken = original;
    for (int i = 0; i < 6; ++i)
      broken.binary[random() % broken.binary.size()] = static_cast<std::byte>(random() & 0xFF);
    survive(broken.glb(), "round " + std::to_string(round));
  }
}

// Replaces one value at a time, anywhere in the JSON, by invalid and extreme ones.
void mutateEach(const GltfBuilder& original, const Json::json_pointer& pointer, const Json& value) {
  static const std::vector<Json> kReplacements = {-1,
                                                  0,
                                                  1,
                                                  3,
                                                  65536,
                                                  2147483647,
                                                  4294967295u,
                                                  9007199254740991,
                                                  18446744073709551615u,
                                                  -2147483648ll,
                                                  1e30,
                                                  0.5,
                                                  "",
                                                  "VEC4",
                                                  nullptr,
                                                  true,
                                                  Json::array(),
                                                  Json::object(),
                                                  Json::array({0, 0, 0, 0})};
  if (value.is_structured()) {
    for (const auto& [key, inside] : value.items())
      mutateEach(original, value.is_array() ? pointer / static_cast<std::size_t>(std::stoul(key)) : pointer / key,
                 inside);
  }
  for (const Json& replacement : kReplacements) {
    GltfBuilder broken = original;
    broken.root[pointer] = replacement;
    survive(broken.glb(), pointer.to_string() + " = " + replacement.dump());
  }
}

TEST(GltfFuzz, SurvivesReplacedJsonValues) {
  const GltfBuilder original = sceneWithEverything();
  for (const auto& [key, value] : original.root.items()) mutateEach(original, Json::json_pointer("/" + key), value);
}

}  // namespace
}  // namespace quintet::test
