// SPDX-License-Identifier: Apache-2.0
// Q713: limits of the search. tests/check has programs with wrong pixels.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "stage_test_support.h"

namespace quintet::check {
namespace {

// The diagnostics for a store at a pixel whose column and row are computed from `x` and `y`.
std::vector<Diagnostic> checkPixel(const std::string& statements) {
  const auto module = compileStage(shader::Stage::rayGeneration,
                                   "layout(set = 1, binding = 0, rgba8) uniform image2D image;\n"
                                   "void main() {\n  uint x = gl_LaunchIDEXT.x, y = gl_LaunchIDEXT.y;\n" +
                                       statements + "\n  imageStore(image, ivec2(x, y), vec4(1.0));\n}\n");
  EXPECT_TRUE(module);
  if (!module) return {};
  Report report;
  checkPixels(*module, report);
  return report.take();
}

std::vector<std::string> checkColumn(const std::string& statements) { return linesOf(checkPixel(statements)); }

TEST(CheckPixels, ReportsScaledPixels) { EXPECT_THAT(checkColumn("x = 2u * x;"), testing::ElementsAre("Q713:7")); }

// The factor is that of the axis which has the problem.
TEST(CheckPixels, StatesTheFactor) {
  const std::string
      times = "the result is stored at the pixel times {}, which is outside of the image for most pixels",
      divided = "the result is stored at the pixel divided by {}, so several invocations store to the same pixel";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"x = 2u * x;", fmt::format(fmt::runtime(times), 2)},
      {"y = y * 3u;", fmt::format(fmt::runtime(times), 3)},
      {"x = x << 3u;", fmt::format(fmt::runtime(times), 8)},
      {"x = uint(2.5 * float(x));", fmt::format(fmt::runtime(times), 2.5)},
      {"x = uint(float(x) / 0.5);", fmt::format(fmt::runtime(times), 2)},
      {"x = x / 2u;", fmt::format(fmt::runtime(divided), 2)},
      {"y = y >> 2u;", fmt::format(fmt::runtime(divided), 4)},
      {"x = uint(0.25 * float(x));", fmt::format(fmt::runtime(divided), 4)},
      {"x = x / 2u; y = 4u * y;", fmt::format(fmt::runtime(times), 4)},
      {"x = 4u * x; y = y / 2u;", fmt::format(fmt::runtime(times), 4)},
      {"x = 2u * (x / 6u);", fmt::format(fmt::runtime(divided), 3)},
      {"x = 6u; y = 7u;", "all invocations store their result at the same pixel (6, 7)"}};
  for (const auto& [statements, message] : cases) {
    const std::vector<Diagnostic> found = checkPixel(statements);
    ASSERT_EQ(found.size(), 1u) << statements;
    EXPECT_EQ(found[0].text, message) << statements;
  }
  EXPECT_THAT(checkColumn("x = (2u * x) / 2u;"), testing::IsEmpty());
}

TEST(CheckPixels, GivesUpOnSumsOfManyTerms) {
  std::string sums;
  for (int i = 0; i < 40; ++i) sums += "x = x + x;";
  EXPECT_THAT(checkColumn(sums + "x = 2u * x;"), testing::IsEmpty());
}

}  // namespace
}  // namespace quintet::check
