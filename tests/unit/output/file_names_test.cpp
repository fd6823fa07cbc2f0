// SPDX-License-Identifier: Apache-2.0
// Where the frame number and the name of the output go in a file name.
#include "output/file_names.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace quintet::output {
namespace {

std::string name(const char* file, const char* output, std::optional<std::uint64_t> frame) {
  return fileName(file, output, frame).generic_string();
}

TEST(FileNames, OneImage) {
  EXPECT_EQ(name("a/out.png", "", {}), "a/out.png");
  EXPECT_EQ(name("100%.png", "", {}), "100%.png");
  EXPECT_EQ(name("-", "", {}), "-");
}

TEST(FileNames, Frames) {
  EXPECT_EQ(name("a.b/out.png", "", 7), "a.b/out.0007.png");
  EXPECT_EQ(name("out_%03d.png", "", 7), "out_007.png");
  EXPECT_EQ(name("%d.png", "", 1234), "1234.png");
  EXPECT_EQ(name("out.%02d.exr", "", 1234), "out.1234.exr");
  EXPECT_EQ(name("100%.png", "", 7), "100%.0007.png");
}

TEST(FileNames, Outputs) {
  EXPECT_EQ(name("d/out.png", "normal", {}), "d/out.normal.png");
  EXPECT_EQ(name("out.%04d.png", "normal", 7), "out.normal.0007.png");
  EXPECT_EQ(name("out_%04d.png", "normal", 7), "out_normal_0007.png");
  EXPECT_EQ(name("out.png", "normal", 7), "out.normal.0007.png");
  EXPECT_EQ(name("%d.png", "normal", 7), "normal.7.png");
}

TEST(FileNames, Hashes) {
  EXPECT_EQ(name("a#b/f####.png", "", 7), "a#b/f0007.png");
  EXPECT_EQ(name("f#.exr", "", 12), "f12.exr");
  EXPECT_EQ(name("##_f.png", "", 0), "00_f.png");
  EXPECT_EQ(name("f.####.png", "normal", 7), "f.normal.0007.png");
  EXPECT_EQ(name("100%_##.png", "", 7), "100%_07.png");
  EXPECT_EQ(name("f####.png", "", {}), "f####.png");
}

TEST(FileNames, FramePattern) {
  EXPECT_TRUE(hasFramePattern("out####.png"));
  EXPECT_FALSE(hasFramePattern("take#1/out.png"));
  EXPECT_THROW(hasFramePattern("a#_#.png"), UsageError);
  EXPECT_THROW(hasFramePattern("%d_##.png"), UsageError);
  EXPECT_TRUE(hasFramePattern("out.%04d.png"));
  EXPECT_FALSE(hasFramePattern("%04d/out.png"));
  EXPECT_FALSE(hasFramePattern("out.png"));
  EXPECT_THROW(hasFramePattern("%d_%d.png"), UsageError);
}

TEST(FileNames, OfProgramsWithoutAnOutputFile) {
  EXPECT_EQ(defaultImage("ao"), "ao.png");
  EXPECT_EQ(defaultImage("lessons/sphere.rt.glsl"), "sphere.png");
  EXPECT_EQ(defaultImage(".hidden"), "out.png");
}

}  // namespace
}  // namespace quintet::output
