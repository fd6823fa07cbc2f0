// SPDX-License-Identifier: Apache-2.0
// Compares every byte with the reference transcoder of Basis Universal. tests/codecs/run.mjs writes the files and runs this
// test (codecs.npm); without it, the test is skipped.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "base/file.h"
#include "io/codec.h"

namespace quintet::io {
namespace {

TEST(ReferenceDecoders, AgreeOnBasisUniversal) {
  const char* folder = std::getenv("QUINTET_REFERENCE_FILES");
  if (!folder) GTEST_SKIP() << "run by codecs.npm";
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".ktx2") continue;
    ++count;
    const Image image = toChannels(readImage(entry.path()), 4);
    const std::vector<std::byte> expected = readFile(std::filesystem::path(entry.path()).replace_extension(".rgba"));
    EXPECT_TRUE(image.data == expected) << entry.path();
  }
  EXPECT_GT(count, 150);
}

}  // namespace
}  // namespace quintet::io
