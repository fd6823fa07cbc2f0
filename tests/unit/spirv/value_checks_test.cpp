// SPDX-License-Identifier: Apache-2.0
// Checks after floating-point operations: the module stays valid, and each operation gets one. tests/cli/find_test.cpp and
// tests/cli/check_test.cpp show what they find.
#include "spirv/value_checks.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "program/instrument.h"
#include "rewrite_test_support.h"
#include "shader/optimizer.h"
#include "shader/shader_test_support.h"
#include "spirv/module.h"

namespace quintet::spirv {
using namespace shader;

namespace {

Words compileChecked(const std::string& text, bool values = true) {
  Source source;
  source.stage = Stage::closestHit;
  source.name = "test" + std::string(stageExtension(source.stage));
  source.text = "#version 460\n#extension GL_EXT_ray_tracing : require\n" + text;
  if (values) source.text = program::probedStage(source.text, source.stage, {.values = true}, false);
  source.optimize = false;
  const Result result = Compiler({}).compile(source);
  EXPECT_TRUE(result.ok()) << all(result);
  return result.spirv;
}

// One operation per line, from line 7 on.
constexpr const char* kOperations = R"(layout(set = 1, binding = 7) uniform sampler2D image;
layout(location = 0) rayPayloadInEXT vec3 color;
void main() {
  vec3 v = color;
  float x = v.x;
  x = sqrt(x);
  v = v / x;
  v = v * x;
  x = dot(v, v);
  v = normalize(v);
  v = mat3(2.0) * v;
  x = length(v.xy);
  v = textureLod(image, v.xy, 0.0).xyz;
  v = max(v, vec3(x)) - v;
  color = v;
}
)";

std::vector<std::string> operationsOf(const Module& module, int firstLine, int lastLine) {
  std::vector<std::string> found;
  for (const CheckedValue& value : findCheckedValues(module)) {
    const SourceLocation at = module.location(module.instructions()[value.instruction]);
    if (at.file.find("test") == std::string::npos || at.line < firstLine || at.line > lastLine) continue;
    found.push_back(std::to_string(at.line) + " " + std::string(value.operation));
  }
  return found;
}

TEST(ValueChecks, FindTheOperationsOfEachLine) {
  const auto module = Module::read(compileChecked(kOperations));
  ASSERT_TRUE(module);
  EXPECT_THAT(operationsOf(*module, 8, 16),
              testing::ElementsAre("8 sqrt", "9 division", "10 multiplication", "11 dot", "12 normalize",
                                   "13 multiplication", "14 length", "15 read of an image", "16 subtraction"));
}

TEST(ValueChecks, KeepTheModuleValid) {
  const Words words = compileChecked(kOperations);
  const auto module = Module::read(words);
  ASSERT_TRUE(module);
  const Words changed = addValueChecks(words, 100);
  EXPECT_EQ(errorsOf(changed), "");
  // One per operation, less the call of valuesKeep_.
  EXPECT_EQ(count(changed, spv::Op::OpFunctionCall),
            count(words, spv::Op::OpFunctionCall) + findCheckedValues(*module).size() - 1);
  EXPECT_EQ(errorsOf(optimize(changed)), "");
}

TEST(ValueChecks, RequireTheFunctions) {
  EXPECT_THROW(addValueChecks(compileChecked(kOperations, false), 0), Error);
  EXPECT_THROW(addValueChecks({}, 0), Error);
}

}  // namespace
}  // namespace quintet::spirv
