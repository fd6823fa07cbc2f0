// SPDX-License-Identifier: Apache-2.0
// Ray generation shaders that read the launch, for the tests of interleaveRows.
#ifndef QUINTET_TESTS_UNIT_SPIRV_LAUNCH_TEST_SUPPORT_H
#define QUINTET_TESTS_UNIT_SPIRV_LAUNCH_TEST_SUPPORT_H

#include <cstdint>
#include <spirv/unified1/spirv.hpp11>
#include <string>
#include <vector>

#include "shader/shader_test_support.h"

namespace quintet::spirv {

// `body` has a 2D image of unsigned integers, `image`.
inline std::vector<std::uint32_t> compileRayGeneration(const std::string& body, bool debugInfo = false) {
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

inline constexpr const char* kStoresAtItsPlace =
    "void main() { uvec3 id = gl_LaunchIDEXT; imageStore(image, ivec2(id.xy), uvec4(1)); }";

// A module that copies pointers instead of loading them, which interleaveRows does not follow. It is not valid.
inline std::vector<std::uint32_t> withCopiedPointers(std::vector<std::uint32_t> words) {
  constexpr std::uint32_t kWordsOfALoad = 4, kHeader = 5;
  std::size_t changed = 0;
  for (std::size_t i = kHeader; i < words.size(); i += words[i] >> 16) {
    if (words[i] != (kWordsOfALoad << 16 | static_cast<std::uint32_t>(spv::Op::OpLoad))) continue;
    words[i] = kWordsOfALoad << 16 | static_cast<std::uint32_t>(spv::Op::OpCopyObject);
    ++changed;
  }
  EXPECT_GT(changed, 0u);
  return words;
}

}  // namespace quintet::spirv
#endif
