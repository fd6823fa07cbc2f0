// SPDX-License-Identifier: Apache-2.0
// The test harness: sizes, indices, defines, addresses and errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness.h"

namespace quintet {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(GpuHarness, SquaresTheInputs) {
  const std::vector<float> inputs = {1, 2, 3, 4, 5};
  const auto squares = test::runCompute<float>(R"(
    #define In float
    #define Out float
    Out run(uint index, In value) { return value * value; }
  )",
                                               inputs);
  EXPECT_EQ(squares, (std::vector<float>{1, 4, 9, 16, 25}));
}

TEST(GpuHarness, RunsMoreInvocationsThanInputs) {
  struct In {
    std::uint32_t first;
    float second[3];
  };
  struct Out {
    std::uint32_t index;
    std::uint32_t first;
    float sum;
  };
  const std::vector<In> inputs = {{7, {1, 2, 3}}, {8, {4, 5, 6}}, {9, {7, 8, 9}}};
  const std::size_t count = 1'100'000;  // more than one row of groups
  const auto outputs = test::runCompute<Out>(R"(
    struct In { uint first; vec3 second; };
    struct Out { uint index; uint first; float sum; };
    Out run(uint index, In value) { return Out(index, value.first, value.second.x + value.second.y + value.second.z); }
  )",
                                             inputs, count);
  ASSERT_EQ(outputs.size(), count);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const In& in = inputs[i % 3];
    const Out& out = outputs[i];
    if (out.index != i || out.first != in.first || out.sum != in.second[0] + in.second[1] + in.second[2]) ++wrong;
  }
  EXPECT_EQ(wrong, 0u);
}

TEST(GpuHarness, RunsWithoutInputs) {
  const auto outputs = test::runCompute<std::uint64_t>(R"(
    #define Out uint64_t
    Out run(uint index) { return uint64_t(index) << 33; }
  )",
                                                       1000);
  for (std::size_t i = 0; i < outputs.size(); ++i) ASSERT_EQ(outputs[i], std::uint64_t{i} << 33);
}

TEST(GpuHarness, PassesAddressesAndDefines) {
  const gpu::Buffer table = gpu::makeBufferOf(test::testContext(), std::vector<float>{3, 1, 4, 1, 5}, 0, "table");
  test::ComputeOptions options;
  options.defines = {{"FACTOR", "10.0"}};
  options.addresses[2] = table.address();
  const auto outputs = test::runCompute<float>(R"(
    #define Out float
    layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Table { float at[]; };
    Out run(uint index) { return FACTOR * Table(testAddress(2)).at[index]; }
  )",
                                               5, options);
  EXPECT_EQ(outputs, (std::vector<float>{30, 10, 40, 10, 50}));
}

TEST(GpuHarness, RejectsStructsOfDifferentSize) {
  struct Out {
    float a, b;
  };
  EXPECT_THAT([] { test::runCompute<Out>("#define Out vec3\nOut run(uint index) { return vec3(1); }", 10); },
              ThrowsMessage<std::runtime_error>(HasSubstr("Out has 8 bytes in C++ and 12 in GLSL")));
}

TEST(GpuHarness, ReportsLinesOfTheBody) {
  EXPECT_THAT([] { test::runCompute<float>("#define Out float\nOut run(uint index) { return nothing; }", 10); },
              ThrowsMessage<std::runtime_error>(HasSubstr("test.comp:2")));
}

TEST(GpuHarness, RunsWholeShaders) {
  gpu::Buffer buffer(test::testContext(), {.size = 256 * 4, .name = "output"});
  const VkDeviceAddress address = buffer.address();
  test::dispatchCompute(R"(#version 460
    #extension GL_EXT_scalar_block_layout : require
    #extension GL_EXT_buffer_reference : require
    layout(local_size_x = 32) in;
    layout(buffer_reference, scalar) buffer Output { uint at[]; };
    layout(push_constant, scalar) uniform Constants { Output result; };
    void main() { result.at[gl_GlobalInvocationID.x] = gl_GlobalInvocationID.x * 3u; }
  )",
                        std::as_bytes(std::span(&address, 1)), 8);
  const auto values = buffer.downloadAs<std::uint32_t>(256);
  for (std::uint32_t i = 0; i < 256; ++i) ASSERT_EQ(values[i], 3 * i);
}

}  // namespace
}  // namespace quintet
