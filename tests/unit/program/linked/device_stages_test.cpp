// SPDX-License-Identifier: Apache-2.0
// The stages of devices with driver defects. tests/gpu/program tests the images.
#include "program/linked/device_stages.h"

#include <gtest/gtest.h>

#include <spirv/unified1/spirv.hpp11>

#include "shader/compiler.h"
#include "spirv/interleave_rows.h"

namespace quintet::program {
namespace {

CompiledProgram compiled() {
  CompiledProgram result;
  result.stages = {{"main.rgen", shader::Stage::rayGeneration, {1}},
                   {"sphere.rint", shader::Stage::intersection, {2, 3}},
                   {"a.rahit", shader::Stage::anyHit, {4}},
                   {"b.rahit", shader::Stage::anyHit, {5}}};
  result.ok = true;
  return result;
}

TEST(DeviceStages, KeepsTheCompiledStagesWithoutDefects) {
  const CompiledProgram program = compiled();
  const DeviceStages stages({}, program, {});
  EXPECT_EQ(stages.index("a.rahit"), 2);
  EXPECT_EQ(stages.index(""), rt::kNoStage);
  EXPECT_EQ(stages.index("sphere.rint"), 1);
  EXPECT_EQ(stages.stages().size(), 4u);
}

std::vector<std::uint32_t> compileRayGeneration() {
  shader::Source source;
  source.stage = shader::Stage::rayGeneration;
  source.name = "main.rgen";
  source.text =
      "#version 460\n#extension GL_EXT_ray_tracing : require\nlayout(binding = 0, r32ui) uniform uimage2D image;\n"
      "void main() { uvec3 id = gl_LaunchIDEXT; imageStore(image, ivec2(id.xy), uvec4(1)); }\n";
  shader::CompilerOptions options;
  options.debugInfo = false;
  const shader::Result result = shader::Compiler(options).compile(source);
  EXPECT_TRUE(result.ok());
  return result.spirv;
}

// If one stage had other rows than the rest, shaders would disagree on the pixel.
TEST(DeviceStages, InterleavesTheRowsOfAllStagesOrOfNone) {
  const std::vector<std::uint32_t> words = compileRayGeneration();
  CompiledProgram program;
  program.stages = {{"a.rgen", shader::Stage::rayGeneration, words}, {"b.rgen", shader::Stage::rayGeneration, words}};
  program.ok = true;
  gpu::Quirks quirks;
  quirks.launchParts = 2;
  const auto moduleOf = [&](std::size_t stage) {
    const DeviceStages stages({}, program, quirks);
    return std::vector<std::uint32_t>(stages.stages()[stage].spirv.begin(), stages.stages()[stage].spirv.end());
  };
  for (std::size_t stage : {0u, 1u}) EXPECT_EQ(moduleOf(stage), spirv::interleaveRows(words, 2));
  EXPECT_NE(moduleOf(0), words);
  for (std::size_t i = 5; i < words.size(); i += words[i] >> 16)  // a pointer that interleaveRows does not follow
    if ((words[i] & 0xFFFFu) == static_cast<std::uint32_t>(spv::Op::OpLoad) && (words[i] >> 16) == 4)
      program.stages[1].spirv[i] = 4u << 16 | static_cast<std::uint32_t>(spv::Op::OpCopyObject);
  ASSERT_FALSE(spirv::canInterleaveRows(program.stages[1].spirv));
  EXPECT_EQ(moduleOf(0), words);
}

}  // namespace
}  // namespace quintet::program
