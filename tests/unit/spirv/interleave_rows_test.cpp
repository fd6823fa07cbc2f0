// SPDX-License-Identifier: Apache-2.0
// The permutation of the rows of a launch: the module stays valid, and which modules are left as they are. tests/gpu/rt/pipeline_test.cpp
// tests the rows.
#include "spirv/interleave_rows.h"

#include <gtest/gtest.h>

#include <spirv/unified1/spirv.hpp11>

#include "shader/optimizer.h"
#include "shader/shader_test_support.h"

namespace quintet::spirv {
namespace {

std::vector<std::uint32_t> compileRayGeneration(const std::string& body, bool debugInfo = true) {
  shader::CompilerOptions options;
  options.debugInfo = debugInfo;
  shader::Source source;
  source.stage = shader::Stage::rayGeneration;
  source.name = "test.rgen";
  source.text =
      "#version 460\n#extension GL_EXT_ray_tracing : require\n"
      "layout(set = 0, binding = 0, r32ui) uniform uimage2D image;\n" +
      body;
  shader::Result result = shader::Compiler(options).compile(source);
  EXPECT_TRUE(result.ok()) << shader::all(result);
  return result.spirv;
}

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

// A pointer to the built-in can be an operand of a call, which glslang does not write. The function then reads the place itself.
TEST(InterleaveRows, RejectsPointersThatItDoesNotFollow) {
  auto words = compileRayGeneration(
      "void main() { uvec3 id = gl_LaunchIDEXT; imageStore(image, ivec2(id.xy), uvec4(1)); }", false);
  std::size_t changed = 0;
  for (std::size_t i = 5; i < words.size(); i += words[i] >> 16) {
    const auto op = static_cast<spv::Op>(words[i] & 0xFFFFu);
    if (op != spv::Op::OpLoad || (words[i] >> 16) != 4) continue;
    words[i] = 4u << 16 | static_cast<std::uint32_t>(spv::Op::OpCopyObject);
    ++changed;
  }
  ASSERT_GT(changed, 0u);
  EXPECT_FALSE(canInterleaveRows(words));
  EXPECT_EQ(interleaveRows(words, 2), words);
}

}  // namespace
}  // namespace quintet::spirv
