// SPDX-License-Identifier: Apache-2.0
// Q713: limits of the search. tests/check has programs with wrong pixels.
#include <gmock/gmock.h>

#include "stage_test_support.h"

namespace quintet::check {
namespace {

// Stores at a pixel whose column is computed from `x`.
std::vector<std::string> checkColumn(const std::string& statements) {
  const auto module =
      compileStage(shader::Stage::rayGeneration,
                   "layout(set = 1, binding = 0, rgba8) uniform image2D image;\n"
                   "void main() {\n  uint x = gl_LaunchIDEXT.x;\n" +
                       statements + "\n  imageStore(image, ivec2(x, gl_LaunchIDEXT.y), vec4(1.0));\n}\n");
  if (!module) return {"does not compile"};
  Report report;
  checkPixels(*module, report);
  return linesOf(report.take());
}

TEST(CheckPixels, ReportsScaledPixels) { EXPECT_THAT(checkColumn("x = 2u * x;"), testing::ElementsAre("Q713:7")); }

TEST(CheckPixels, GivesUpOnSumsOfManyTerms) {
  std::string sums;
  for (int i = 0; i < 40; ++i) sums += "x = x + x;";
  EXPECT_THAT(checkColumn(sums + "x = 2u * x;"), testing::IsEmpty());
}

}  // namespace
}  // namespace quintet::check
