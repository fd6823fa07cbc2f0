// SPDX-License-Identifier: Apache-2.0
// The permutation of the rows of a launch: the module stays valid, and which modules are left as they are. tests/gpu/rt/pipeline_test.cpp
// tests the rows.
#include "spirv/interleave_rows.h"

#include <gtest/gtest.h>

#include "shader/optimizer.h"
#include "spirv/launch_test_support.h"

namespace quintet::spirv {
namespace {

TEST(InterleaveRows, KeepsModulesValid) {
  for (const bool debugInfo : {false, true}) {
    for (const std::string body : {
             "void main() { imageStore(image, ivec2(gl_LaunchIDEXT.xy), uvec4(1)); }",
             "void main() { imageStore(image, ivec2(gl_LaunchIDEXT.y, gl_LaunchSizeEXT.y), uvec4(gl_LaunchIDEXT.z)); }",
             "void main() { for (int i = 0; i < 3; ++i) imageStore(image, ivec2(i), uvec4(gl_LaunchIDEXT[i])); }",
             "uint f(uvec3 id) { return id.y; }\nvoid main() { imageStore(image, ivec2(0), uvec4(f(gl_LaunchIDEXT))); "
             "}",
         }) {
      const auto words = compileRayGeneration(body, debugInfo);
      EXPECT_TRUE(canInterleaveRows(words)) << body;
      const auto interleaved = interleaveRows(words, 4);
      EXPECT_NE(interleaved, words) << body;
      EXPECT_EQ(shader::validate(interleaved).text, "") << body;
    }
  }
}

TEST(InterleaveRows, KeepsModulesThatDoNotReadTheLaunch) {
  const auto words = compileRayGeneration("void main() { imageStore(image, ivec2(gl_LaunchSizeEXT.xy), uvec4(1)); }");
  EXPECT_TRUE(canInterleaveRows(words));
  EXPECT_EQ(interleaveRows(words, 2), words);
  EXPECT_TRUE(canInterleaveRows({}));
  EXPECT_TRUE(interleaveRows({}, 2).empty());
}

// glslang only loads the built-in. Other compilers can copy a pointer to it.
TEST(InterleaveRows, RejectsPointersThatItDoesNotFollow) {
  const auto words = withCopiedPointers(compileRayGeneration(kStoresAtItsPlace));
  EXPECT_FALSE(canInterleaveRows(words));
  EXPECT_EQ(interleaveRows(words, 2), words);
}

}  // namespace
}  // namespace quintet::spirv
