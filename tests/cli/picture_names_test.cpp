// Where the frame's number and the output's name go in a file name.
#include "picture_names.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace quintet::app {
namespace {

std::string name(const char* file, const char* output, std::optional<std::uint32_t> frame) {
  return pictureName(file, output, frame).generic_string();
}

TEST(PictureNames, OnePicture) {
  EXPECT_EQ(name("a/out.png", "", {}), "a/out.png");
  EXPECT_EQ(name("100%.png", "", {}), "100%.png");
  EXPECT_EQ(name("-", "", {}), "-");
}

TEST(PictureNames, Frames) {
  EXPECT_EQ(name("a.b/out.png", "", 7u), "a.b/out.0007.png");
  EXPECT_EQ(name("out_%03d.png", "", 7u), "out_007.png");
  EXPECT_EQ(name("%d.png", "", 1234u), "1234.png");
  EXPECT_EQ(name("out.%02d.exr", "", 1234u), "out.1234.exr");
  EXPECT_EQ(name("100%.png", "", 7u), "100%.0007.png");
}

TEST(PictureNames, Outputs) {
  EXPECT_EQ(name("d/out.png", "normal", {}), "d/out.normal.png");
  EXPECT_EQ(name("out.%04d.png", "normal", 7u), "out.normal.0007.png");
  EXPECT_EQ(name("out_%04d.png", "normal", 7u), "out_normal_0007.png");
  EXPECT_EQ(name("out.png", "normal", 7u), "out.normal.0007.png");
  EXPECT_EQ(name("%d.png", "normal", 7u), "normal.7.png");
}

TEST(PictureNames, PlaceOfTheFrame) {
  EXPECT_TRUE(hasFramePlace("out.%04d.png"));
  EXPECT_FALSE(hasFramePlace("%04d/out.png"));
  EXPECT_FALSE(hasFramePlace("out.png"));
  EXPECT_THROW(hasFramePlace("%d_%d.png"), UsageError);
}

}  // namespace
}  // namespace quintet::app
