// SPDX-License-Identifier: Apache-2.0
// Pipelines and launches: invalid options, empty tables, callable shaders, and the reuse of pipelines.
#include <algorithm>

#include "base/error.h"
#include "program/linked/device_stages.h"
#include "rt_test_support.h"
#include "spirv/interleave_rows.h"

namespace quintet::rt::test {
namespace {

struct OneShader {
  explicit OneShader(shader::Stage stage, const std::string& text) : spirv(compileStage(stage, text)) {
    options.stages = {{program::vulkanStage(stage), spirv, "only"}};
    options.groups = {{.general = 0}};
    options.name = "single";
  }
  std::vector<std::uint32_t> spirv;
  PipelineOptions options;
};

TEST(RtPipeline, RejectsDeepRecursionAndMissingRayGeneration) {
  OneShader rayGeneration(shader::Stage::rayGeneration, "void main() {}");
  rayGeneration.options.maxRecursionDepth = quintet::test::testContext().info().limits.maxRecursionDepth + 1;
  EXPECT_THROW(Pipeline(quintet::test::testContext(), testSet(), rayGeneration.options, nullptr), UsageError);
  OneShader miss(shader::Stage::miss, "void main() {}");
  EXPECT_THROW(Pipeline(quintet::test::testContext(), testSet(), miss.options, nullptr), UsageError);
}

TEST(RtPipeline, SupportsEmptyTablesAndLaunches) {
  const OneShader shader(shader::Stage::rayGeneration,
                         "void main() { launch.hits.at[gl_LaunchIDEXT.x].primitive = 7; }");
  const gpu::PipelineCache cache(quintet::test::testContext(), {});
  const Pipeline pipeline(quintet::test::testContext(), testSet(), shader.options, &cache);
  const ShaderBindingTable table(quintet::test::testContext(), pipeline, {}, "only ray generation");
  const gpu::Buffer hits = gpu::makeBufferOf(quintet::test::testContext(), std::vector<Hit>(3), 0, "hits");
  const std::uint64_t constants[] = {0, hits.address()};
  const auto bytes = std::as_bytes(std::span(constants));
  quintet::test::testContext().submitAndWait([&](gpu::Commands& commands) {
    trace(commands, pipeline, table, bytes, 0, 5);
    trace(commands, pipeline, table, bytes, 2, 1);
    EXPECT_THROW(trace(commands, pipeline, table, bytes, 1u << 31, 1u << 31, 4), UsageError);
  });
  const auto result = hits.downloadAs<Hit>(3);
  EXPECT_EQ(result[0].primitive, 7u);
  EXPECT_EQ(result[1].primitive, 7u);
  EXPECT_EQ(result[2].primitive, 0u);
}

TEST(RtPipeline, ReadsRecordsInCallables) {
  const auto rayGeneration = compileStage(shader::Stage::rayGeneration, R"(
    layout(location = 0) callableDataEXT uint data;
    void main() {
      data = 0;
      executeCallableEXT(gl_LaunchIDEXT.x, 0);
      launch.hits.at[gl_LaunchIDEXT.x].tag = data;
    })");
  const auto callable = compileStage(shader::Stage::callable, R"(
    layout(location = 0) callableDataInEXT uint data;
    layout(shaderRecordEXT, scalar) buffer Record { uint tag; } record;
    void main() { data = record.tag; })");
  PipelineOptions options;
  options.stages = {{VK_SHADER_STAGE_RAYGEN_BIT_KHR, rayGeneration, "rgen"},
                    {VK_SHADER_STAGE_CALLABLE_BIT_KHR, callable, "rcall"}};
  options.groups = {{.general = 0}, {.general = 1}};
  const Pipeline pipeline(quintet::test::testContext(), testSet(), options, nullptr);
  SbtContents contents;
  for (std::uint32_t k = 0; k < 9; ++k) {
    SbtRecord record{1, std::vector<std::byte>(4 + 4 * (k % 3))};  // records of several sizes
    const std::uint32_t tag = 100 + k;
    std::memcpy(record.data.data(), &tag, sizeof tag);
    contents.callable.push_back(std::move(record));
  }
  const ShaderBindingTable table(quintet::test::testContext(), pipeline, contents, "callables");
  const gpu::Buffer hits = gpu::makeBufferOf(quintet::test::testContext(), std::vector<Hit>(9), 0, "hits");
  const std::uint64_t constants[] = {0, hits.address()};
  quintet::test::testContext().submitAndWait(
      [&](gpu::Commands& commands) { trace(commands, pipeline, table, std::as_bytes(std::span(constants)), 9, 1); });
  const auto result = hits.downloadAs<Hit>(9);
  for (std::uint32_t k = 0; k < 9; ++k) EXPECT_EQ(result[k].tag, 100 + k);
}

TEST(RtPipeline, RejectsTooLargeRecords) {
  SbtContents contents = contentsOf({});
  contents.miss[0].data.resize(quintet::test::testContext().info().limits.maxRecordStride);
  EXPECT_THROW(ShaderBindingTable(quintet::test::testContext(), testPipeline(), contents, "fat"), UsageError);
}

// All of these are part of the key for the reuse of pipelines (gpu::PipelineStore).
TEST(RtPipeline, ReusesPipelinesWithEqualOptions) {
  OneShader shader(shader::Stage::rayGeneration, "void main() { launch.hits.at[0].tag = 1; }");
  const auto other = compileStage(shader::Stage::rayGeneration, "void main() { launch.hits.at[0].tag = 2; }");
  shader.options.stages.push_back({VK_SHADER_STAGE_RAYGEN_BIT_KHR, other, "other"});
  const Pipeline first(quintet::test::testContext(), testSet(), shader.options, nullptr);
  PipelineOptions same = shader.options;
  same.name = "same", same.stages[0].name = "same";
  const Pipeline second(quintet::test::testContext(), testSet(), same, nullptr);
  EXPECT_EQ(second.handle(), first.handle());
  EXPECT_TRUE(std::ranges::equal(second.groupHandles(), first.groupHandles()));
  std::vector<PipelineOptions> different(4, shader.options);
  different[0].maxRecursionDepth = 2;
  different[1].groups[0].general = 1;
  different[2].groups.push_back({.general = 1});
  std::swap(different[3].stages[0], different[3].stages[1]);
  std::vector<VkPipeline> handles = {first.handle()};
  std::vector<std::unique_ptr<Pipeline>> pipelines;
  for (const PipelineOptions& options : different) {
    pipelines.push_back(std::make_unique<Pipeline>(quintet::test::testContext(), testSet(), options, nullptr));
    EXPECT_EQ(std::ranges::count(handles, pipelines.back()->handle()), 0) << handles.size();
    handles.push_back(pipelines.back()->handle());
  }
  // lavapipe gives the same shaders new handles in each pipeline, so its disk cache never finds a pipeline again.
  if (quintet::test::testContext().info().software) {
    EXPECT_FALSE(std::ranges::equal(pipelines[0]->groupHandles(), first.groupHandles())) << "the driver is fixed";
  }
  const gpu::BindlessSet smaller(quintet::test::testContext(), 0, testSet().pushConstantBytes() / 2);
  EXPECT_NE(Pipeline(quintet::test::testContext(), smaller, shader.options, nullptr).handle(), first.handle());
}

// The row of the driver that becomes row y: the definition, step by step.
std::uint32_t rowOfDriver(std::uint32_t y, std::uint32_t height, std::uint32_t parts) {
  std::vector<std::uint32_t> rows;  // in the order of the driver
  for (std::uint32_t part = 0; part < parts; ++part)
    for (std::uint32_t i = 0; i < height / parts; ++i) rows.push_back(i * parts + part);
  while (rows.size() < height) rows.push_back(static_cast<std::uint32_t>(rows.size()));
  return static_cast<std::uint32_t>(std::ranges::find(rows, y) - rows.begin());
}

// Only the ray generation shader has other rows. The callable shader returns the place where the driver runs it.
TEST(RtPipeline, InterleavesTheRowsOfALaunch) {
  constexpr std::uint32_t kWidth = 5;
  const auto callable = compileStage(shader::Stage::callable, R"(
    layout(location = 0) callableDataInEXT uvec3 place;
    void main() { place = gl_LaunchIDEXT; })");
  // A component, the whole, and an index that only the launch knows; with and without the size of the launch.
  for (const std::string row : {"gl_LaunchIDEXT.y", "(gl_LaunchIDEXT * uvec3(1, gl_LaunchSizeEXT.x / 5, 1)).y",
                                "gl_LaunchIDEXT[1u + place.z]"}) {
    const auto rayGeneration = compileStage(shader::Stage::rayGeneration, R"(
      layout(location = 0) callableDataEXT uvec3 place;
      void main() {
        executeCallableEXT(0, 0);
        const uint i = )" + row + R"( * 5u + gl_LaunchIDEXT.x;
        launch.hits.at[i].primitive = place.x;
        launch.hits.at[i].geometry = place.y;
        launch.hits.at[i].custom += 1u;
      })");
    for (const std::uint32_t parts : {1u, 2u, 3u, 32u}) {
      const auto interleaved = spirv::interleaveRows(rayGeneration, parts);
      EXPECT_NE(interleaved, rayGeneration);
      PipelineOptions options;
      options.stages = {{VK_SHADER_STAGE_RAYGEN_BIT_KHR, interleaved, "rgen"},
                        {VK_SHADER_STAGE_CALLABLE_BIT_KHR, callable, "rcall"}};
      options.groups = {{.general = 0}, {.general = 1}};
      const Pipeline pipeline(quintet::test::testContext(), testSet(), options, nullptr);
      SbtContents contents;
      contents.callable.push_back({1, {}});
      const ShaderBindingTable table(quintet::test::testContext(), pipeline, contents, "places");
      for (const std::uint32_t height : {1u, 4u, 13u, 64u}) {
        const gpu::Buffer hits =
            gpu::makeBufferOf(quintet::test::testContext(), std::vector<Hit>(kWidth * height), 0, "hits");
        const std::uint64_t constants[] = {0, hits.address()};
        quintet::test::testContext().submitAndWait([&](gpu::Commands& commands) {
          trace(commands, pipeline, table, std::as_bytes(std::span(constants)), kWidth, height);
        });
        const auto result = hits.downloadAs<Hit>(kWidth * height);
        for (std::uint32_t i = 0; i < kWidth * height; ++i) {
          SCOPED_TRACE(row + ", " + std::to_string(parts) + " parts, height " + std::to_string(height));
          ASSERT_EQ(result[i].custom, 1u) << "column " << i % kWidth << ", row " << i / kWidth;
          ASSERT_EQ(result[i].primitive, i % kWidth);
          ASSERT_EQ(result[i].geometry, rowOfDriver(i / kWidth, height, parts)) << "row " << i / kWidth;
        }
      }
    }
  }
}

}  // namespace
}  // namespace quintet::rt::test
