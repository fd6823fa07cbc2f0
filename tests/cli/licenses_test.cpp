// SPDX-License-Identifier: Apache-2.0
// `licenses`: the texts of the libraries that the build has found (tests/setup/notices.cmake tests missing ones).
#include <gmock/gmock.h>

#include "fixtures.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Licenses : public CliTest {};

TEST_F(Licenses, ContainEachComponent) {
  const RunResult result = quintet({"licenses"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
  for (const char* title :
       {"glslang", "SPIRV-Tools", "shaderc", "tinygltf", "Draco", "meshoptimizer", "{fmt}", "JSON for Modern C++",
        "CLI11", "toml++", "xxHash", "Vulkan Memory Allocator", "volk", "GLM", "Vulkan headers", "SPIRV-Headers"})
    EXPECT_THAT(result.out, HasSubstr(std::string("\n    ") + title + "\n")) << title;
  // A text of the MIT license, and the license to which packages of Debian refer.
  EXPECT_THAT(result.out, HasSubstr("to deal in the Software without restriction"));
  EXPECT_THAT(result.out, HasSubstr("TERMS AND CONDITIONS FOR USE, REPRODUCTION, AND DISTRIBUTION"));
  EXPECT_THAT(result.out, Not(HasSubstr("INCOMPLETE")));
#ifdef QUINTET_HAS_VIEWER
  EXPECT_THAT(result.out, HasSubstr("\n    Dear ImGui\n"));
#endif
}

TEST_F(Licenses, TakeNoArguments) { expectError(quintet({"licenses", "fmt"}), 2, {"fmt"}); }

}  // namespace
}  // namespace quintet::test
