// SPDX-License-Identifier: Apache-2.0
// Compares with meshoptimizer's decoder. tests/codecs/run.mjs writes the files and runs this test (codecs.npm);
// without it, the test is skipped.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/file.h"
#include "scene/gltf/meshopt.h"

namespace quintet::test {
namespace {

int component(const std::vector<std::byte>& bytes, std::size_t at, std::size_t size) {
  const int low = std::to_integer<int>(bytes[at]);
  return size == 1 ? low : low | std::to_integer<int>(bytes[at + 1]) << 8;
}

TEST(ReferenceDecoders, AgreeOnMeshoptVersion1) {
  const char* folder = std::getenv("QUINTET_REFERENCE_FILES");
  if (!folder) GTEST_SKIP() << "run by codecs.npm";
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".meshopt") continue;
    ++count;
    const std::string name = entry.path().stem().string();  // COUNT_STRIDE_FILTER_N
    const std::size_t elements = std::stoul(name), stride = std::stoul(name.substr(name.find('_') + 1));
    std::vector<std::byte> decoded(elements * stride);
    ASSERT_TRUE(scene::decodeMeshoptVersion1(decoded, stride, readFile(entry.path()))) << name;
    const std::vector<std::byte> expected = readFile(std::filesystem::path(entry.path()).replace_extension(".bytes"));
    if (name.find("COLOR") == name.npos) {
      EXPECT_TRUE(decoded == expected) << name;
      continue;
    }
    // The specification allows a difference of 1: the reference converts with floats, which can miss the nearest value.
    scene::decodeMeshoptColors(decoded, stride);
    ASSERT_EQ(decoded.size(), expected.size());
    for (std::size_t i = 0; i < decoded.size(); i += stride / 4)
      ASSERT_LE(std::abs(component(decoded, i, stride / 4) - component(expected, i, stride / 4)), 1)
          << name << ' ' << i;
  }
  EXPECT_GT(count, 500);
}

}  // namespace
}  // namespace quintet::test
