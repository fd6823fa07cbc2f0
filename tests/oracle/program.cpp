// SPDX-License-Identifier: Apache-2.0
#include "program.h"

#include <gtest/gtest.h>

#include "harness.h"
#include "program/linked/device_stages.h"

namespace quintet::oracle {
namespace {

constexpr char kHeader[] = R"(#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
)";

constexpr char kAfterCommon[] = R"(
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Inputs { Input at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Outputs { Output at[]; };
layout(push_constant, scalar) uniform Launch { Inputs inputs; Outputs outputs; uint64_t address[4]; uvec4 user; } launch;
uint launchIndex() { return (gl_LaunchIDEXT.z * gl_LaunchSizeEXT.y + gl_LaunchIDEXT.y) * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x; }
#line 1
)";

std::unique_ptr<gpu::BindlessSet> sharedSet;

// The stages and groups of a program: ray generation, miss, hit and callable groups, in this order.
class Assembler {
 public:
  explicit Assembler(const ProgramText& text) : text_(text) {
    options_.groups.push_back({.general = stage(shader::Stage::rayGeneration, text.rayGeneration)});
    for (const std::string& miss : text.miss) options_.groups.push_back({.general = stage(shader::Stage::miss, miss)});
    for (const HitGroupText& hit : text.hit)
      options_.groups.push_back({.closestHit = stage(shader::Stage::closestHit, hit.closestHit),
                                 .anyHit = stage(shader::Stage::anyHit, hit.anyHit),
                                 .intersection = stage(shader::Stage::intersection, hit.intersection)});
    for (const std::string& callable : text.callable)
      options_.groups.push_back({.general = stage(shader::Stage::callable, callable)});
    options_.maxRecursionDepth = text.recursion;
    options_.name = "oracle";
    for (std::size_t k = 0; k < spirv_.size(); ++k)
      options_.stages.push_back({program::vulkanStage(kinds_[k]), spirv_[k], "oracle"});
  }
  const rt::PipelineOptions& options() const { return options_; }

 private:
  int stage(shader::Stage kind, const std::string& text) {
    if (text.empty()) return rt::kNoStage;
    for (std::size_t k = 0; k < texts_.size(); ++k)
      if (kinds_[k] == kind && texts_[k] == text) return static_cast<int>(k);
    kinds_.push_back(kind);
    texts_.push_back(text);
    spirv_.push_back(compileStage(kind, text_.common, text));
    return static_cast<int>(texts_.size() - 1);
  }
  const ProgramText& text_;
  std::vector<shader::Stage> kinds_;
  std::vector<std::string> texts_;
  std::vector<std::vector<std::uint32_t>> spirv_;
  rt::PipelineOptions options_;
};

std::uint32_t countOf(std::size_t n) { return static_cast<std::uint32_t>(n); }

}  // namespace

std::vector<std::uint32_t> compileStage(shader::Stage stage, const std::string& common, const std::string& text) {
  // Without optimization, because the optimizer merges reads of a built-in before and after a trace or a report
  // (SPIRV-Tools 2023.2).
  static const shader::Compiler compiler{
      shader::CompilerOptions{.cacheFolder = test::shaderCache(), .optimize = false}};
  shader::Source source;
  source.stage = stage;
  source.text = kHeader + common + kAfterCommon + text;
  source.name = "oracle" + std::string(shader::stageExtension(stage));
  shader::Result result = compiler.compile(source);
  std::string messages;
  for (const Diagnostic& d : result.diagnostics) messages += "\n" + d.format();
  if (!result.ok()) throw std::runtime_error("the shader does not compile:" + messages + "\n" + text);
  return std::move(result.spirv);
}

void atEnd(std::function<void()> destroy) {
  struct Cleaner : testing::Environment {
    explicit Cleaner(std::function<void()> f) : destroy(std::move(f)) {}
    void TearDown() override { destroy(); }
    std::function<void()> destroy;
  };
  testing::AddGlobalTestEnvironment(new Cleaner(std::move(destroy)));
}

gpu::BindlessSet& Program::set() {
  if (!sharedSet) {
    sharedSet = std::make_unique<gpu::BindlessSet>(test::testContext(), 0, 128);
    atEnd([] { sharedSet.reset(); });
  }
  return *sharedSet;
}

Program::Program(const ProgramText& text)
    : missCount_(countOf(text.miss.size())),
      hitCount_(countOf(text.hit.size())),
      callableCount_(countOf(text.callable.size())) {
  pipeline_ = std::make_unique<rt::Pipeline>(test::testContext(), set(), Assembler(text).options(), nullptr);
}

Table Program::plainTable() const {
  Table table;
  for (std::uint32_t k = 0; k < missCount_; ++k) table.miss.push_back({k});
  for (std::uint32_t k = 0; k < hitCount_; ++k) table.hit.push_back({k});
  for (std::uint32_t k = 0; k < callableCount_; ++k) table.callable.push_back({k});
  return table;
}

rt::SbtContents Program::contents(const Table& table) const {
  rt::SbtContents contents;
  const auto fill = [](std::vector<rt::SbtRecord>& to, const std::vector<Record>& from, std::uint32_t first,
                       std::uint32_t count) {
    for (const Record& record : from) {
      if (record.shader >= count) throw std::out_of_range("oracle: a record refers to an unknown shader");
      to.push_back({first + record.shader, record.data});
    }
  };
  fill(contents.miss, table.miss, 1, missCount_);
  fill(contents.hit, table.hit, 1 + missCount_, hitCount_);
  fill(contents.callable, table.callable, 1 + missCount_ + hitCount_, callableCount_);
  return contents;
}

std::vector<std::byte> detail::launch(const Program& program, VkAccelerationStructureKHR tlas,
                                      std::span<const std::byte> inputs, std::size_t inputCount, std::size_t outputSize,
                                      const LaunchOptions& options) {
  gpu::Context& context = test::testContext();
  const uvec3 size = options.size.x == 0 ? uvec3(countOf(inputCount), 1, 1) : options.size;
  const std::size_t count = options.outputs ? options.outputs : std::size_t{size.x} * size.y * size.z;
  const gpu::Buffer inputBuffer = gpu::makeBuffer(context, inputs, 0, "oracle inputs");
  const gpu::Buffer outputBuffer =
      gpu::makeBufferOf(context, std::vector<std::byte>(count * outputSize), 0, "oracle outputs");
  const rt::ShaderBindingTable table(context, program.pipeline(),
                                     program.contents(options.table ? *options.table : program.plainTable()),
                                     "oracle table");
  Program::set().setAccelerationStructure(tlas);
  const LaunchConstants constants{inputBuffer.address(), outputBuffer.address(), options.addresses, options.user};
  context.wait(context.submit([&](gpu::Commands& commands) {
    rt::trace(commands, program.pipeline(), table, std::as_bytes(std::span(&constants, 1)), size.x, size.y, size.z);
  }),
               120.0);
  return outputBuffer.downloadAs<std::byte>(count * outputSize);
}

}  // namespace quintet::oracle
