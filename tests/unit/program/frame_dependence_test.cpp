// SPDX-License-Identifier: Apache-2.0
// Which programs render the same frame again and again.
#include "program/frame_dependence.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

#include "program/lecture/lecture.h"
#include "program/load.h"

namespace quintet::program {
namespace {

bool canDiffer(const std::string& body, const std::string& common = "", std::map<std::string, std::string> files = {}) {
  return framesCanDiffer(parseLecture(common + "\nvoid main() { /**** RAY GENERATION SHADER ****/\n" + body +
                                          "\ngsnSetPixel(vec4(gl_LaunchIDEXT.x));\n}\n",
                                      "demo.rt.glsl", "here", std::move(files)));
}

TEST(FrameDependence, FramesAreEqualWithoutTheIndexThePreviousFrameAndClocks) {
  EXPECT_FALSE(canDiffer(""));
  EXPECT_FALSE(canDiffer("int n = frameSize; // frameID in a comment\n#if 0\nn = frameID;\n#endif"));
  EXPECT_TRUE(canDiffer("int n = frameID;"));
  EXPECT_TRUE(canDiffer("vec4 v = gsnGetPreviousPixel();"));
  EXPECT_TRUE(canDiffer("uint64_t t = clockRealtimeEXT();", "#extension GL_EXT_shader_realtime_clock : require"));
  EXPECT_TRUE(canDiffer("int n = TIME;", "#define TIME frameID"));
  EXPECT_TRUE(canDiffer("int n = J(frame, ID);", "#define J(a, b) a ## b"));
}

TEST(FrameDependence, CountsIncludedFilesAndTheLibrary) {
  const std::string include = "#include \"common.glsl\"";
  EXPECT_FALSE(canDiffer("", include, {{"common.glsl", "float f() { return 1.0; }\n"}}));
  EXPECT_TRUE(canDiffer("", include, {{"common.glsl", "float f() { return float(frameID); }\n"}}));
  EXPECT_TRUE(canDiffer("", include)) << "a file that was not read";
  EXPECT_TRUE(canDiffer("", "#include <quintet/random.glsl>"));
}

TEST(FrameDependence, OfTheLessons) {
  const auto ofLesson = [](const std::string& name) {
    return framesCanDiffer(loadProgram("<programs/lessons/" + name + ">"));
  };
  for (const char* name : {"01_first_ray", "04_diffuse", "07_mirror_recursion", "13_triangle", "16_callable"})
    EXPECT_FALSE(ofLesson(name)) << name;
  for (const char* name : {"05_shadow", "09_progressive", "22_path_tracer", "20_lambert"})
    EXPECT_TRUE(ofLesson(name)) << name;
}

}  // namespace
}  // namespace quintet::program
