// SPDX-License-Identifier: Apache-2.0
#include "harness.h"

#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "shader/compiler.h"

#if defined(__SANITIZE_ADDRESS__)
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libvulkan\nleak:libVkLayer\nleak:libLLVM\nleak:libgallium\nleak:libnvidia\nleak:libGLX_nvidia\n";
}
#endif

namespace quintet::test {
namespace {

constexpr std::uint32_t kGroupSize = 64;
constexpr std::uint32_t kRowGroups = 16384;  // groups per row of a dispatch; Vulkan guarantees 65,535
constexpr double kTimeout = 300.0;           // seconds for one dispatch

// Drivers and layers keep memory until the process ends. AddressSanitizer recognizes these leaks by the name of the
// file (__lsan_default_suppressions above), so the files must stay loaded until its leak check at the end.
void keepDriversLoaded() {
#if defined(__SANITIZE_ADDRESS__)
  std::vector<std::string> files;
  ::dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* data) {
        if (info->dlpi_name && *info->dlpi_name)
          static_cast<std::vector<std::string>*>(data)->push_back(info->dlpi_name);
        return 0;
      },
      &files);
  for (const std::string& file : files) ::dlopen(file.c_str(), RTLD_NOW | RTLD_NOLOAD | RTLD_NODELETE);
#endif
}

// The device of this process with its descriptor set and pipelines.
struct Device {
  explicit Device(const gpu::ContextOptions& options) : context(options), set(context, 0, 128) {}
  gpu::Context context;
  gpu::BindlessSet set;
  std::map<std::string, std::unique_ptr<gpu::ComputePipeline>> pipelines;  // by source, for `set`
};

// Exists longer than the device, because destroying the device can cause messages too.
std::vector<std::string> validationLog;
std::mutex validationMutex;
std::unique_ptr<Device> device;

Device& testDevice() {
  if (device) return *device;
  gpu::ContextOptions options;
  options.log = testLog();
  device = std::make_unique<Device>(options);
  keepDriversLoaded();
  std::printf("device: %s (%s)%s\n", device->context.info().name.c_str(), device->context.info().driver.c_str(),
              options.validate ? ", validated" : "");
  return *device;
}

class DeviceEnvironment : public testing::Environment {
 public:
  void TearDown() override {
    device.reset();
    for (const std::string& line : validationLog) ADD_FAILURE() << line;
  }
};

std::string keyOf(const std::string& glsl, const Defines& defines) {
  std::string key;
  for (const auto& [name, value] : defines) key += fmt::format("{}={}\n", name, value);
  return key + glsl;
}

void runPipeline(const gpu::ComputePipeline& pipeline, std::span<const std::byte> constants, std::uint32_t x,
                 std::uint32_t y, std::uint32_t z) {
  gpu::Context& context = testContext();
  context.wait(context.submit([&](gpu::Commands& commands) {
    pipeline.dispatch(commands, constants, x, y, z);
    commands.toHost(gpu::Stage::compute);
  }),
               kTimeout);
}

const gpu::ComputePipeline& cachedPipeline(const std::string& glsl, const Defines& defines) {
  Device& owner = testDevice();
  auto& pipeline = owner.pipelines[keyOf(glsl, defines)];
  if (!pipeline)
    pipeline = std::make_unique<gpu::ComputePipeline>(owner.context, owner.set, compileCompute(glsl, defines),
                                                      VkPipelineCache{VK_NULL_HANDLE}, "test");
  return *pipeline;
}

// Host side of `TestBlock` below.
struct TestBlock {
  VkDeviceAddress inputs;
  VkDeviceAddress outputs;
  VkDeviceAddress sizes;
  std::array<VkDeviceAddress, 8> addresses;
  std::uint32_t count;
  std::uint32_t inputCount;
};
static_assert(sizeof(TestBlock) == 96);

// Host side of shared/frame.h's Launch, the push constants of all programs.
struct Launch {
  VkDeviceAddress frame;
  VkDeviceAddress parameters;  // of TestBlock
  std::array<std::uint32_t, 4> rest{};
};
static_assert(sizeof(Launch) == 32);

constexpr const char* kBefore = R"(#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_nonuniform_qualifier : require
#extension GL_GOOGLE_include_directive : require
uint64_t testAddress(uint index);
#line 1
)";

// The data is in a buffer because a shader has only one block of push constants, which frame.glsl of the shader library
// declares.
constexpr const char* kAfter = R"(
#line 1
#ifndef QUINTET_SHARED_FRAME_H
struct Launch { uint64_t frameAddress; uint64_t parameterAddress; uvec2 offset; uint firstSample; uint sampleCount; };
#endif
#ifndef QUINTET_FRAME_GLSL
layout(push_constant, scalar) uniform LaunchBlock { Launch launch; };
#endif
layout(local_size_x = 64) in;
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer TestBlock {
  uint64_t inputs; uint64_t outputs; uint64_t sizes; uint64_t addresses[8]; uint count; uint inputCount;
};
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer TestSizes { uint at[2]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer TestOutputs { Out at[]; };
// The sizes of these differ by the size of one array element.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TestOutputs2 { Out at[2]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TestOutputs3 { Out at[3]; };
#ifdef TEST_HAS_INPUT
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TestInputs { In at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TestInputs2 { In at[2]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TestInputs3 { In at[3]; };
#endif
uint64_t testAddress(uint index) { return TestBlock(launch.parameterAddress).addresses[index]; }
void main() {
  TestBlock test = TestBlock(launch.parameterAddress);
  uint index = gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * 64u) + gl_GlobalInvocationID.x;
  if (index == 0u)
    TestSizes(test.sizes).at[0] = uint(uint64_t(TestOutputs3(0ul) + 1) - uint64_t(TestOutputs2(0ul) + 1));
#ifdef TEST_HAS_INPUT
  if (index == 0u)
    TestSizes(test.sizes).at[1] = uint(uint64_t(TestInputs3(0ul) + 1) - uint64_t(TestInputs2(0ul) + 1));
  if (index < test.count)
    TestOutputs(test.outputs).at[index] = run(index, TestInputs(test.inputs).at[index % test.inputCount]);
#else
  if (index < test.count) TestOutputs(test.outputs).at[index] = run(index);
#endif
}
)";

void checkSize(const char* name, std::size_t host, std::uint32_t shader) {
  if (host != shader)
    throw std::runtime_error(fmt::format("runCompute: {} has {} bytes in C++ and {} in GLSL", name, host, shader));
}

}  // namespace

gpu::Context& testContext() { return testDevice().context; }

const gpu::BindlessSet& testSet() { return testDevice().set; }

std::filesystem::path shaderCache() { return cacheFolder() / "shaders"; }

std::vector<std::uint32_t> compileCompute(const std::string& glsl, const Defines& defines) {
  static const shader::Compiler compiler{shader::CompilerOptions{.cacheFolder = shaderCache()}};
  shader::Source source;
  source.text = glsl;
  source.name = "test.comp";
  source.defines = defines;
  shader::Result result = compiler.compile(source);
  if (result.ok()) return std::move(result.spirv);
  std::string text = "the shader does not compile:";
  for (const Diagnostic& diagnostic : result.diagnostics) text += "\n" + diagnostic.format();
  throw std::runtime_error(text);
}

LogSink testLog() {
  return [](LogLevel level, const std::string& line) {
    if (level != LogLevel::warning || !line.starts_with("Vulkan validation: ")) return;
    const std::lock_guard lock(validationMutex);
    validationLog.push_back(line);
  };
}

void dispatchCompute(const std::string& glsl, std::span<const std::byte> constants, std::uint32_t groupsX,
                     std::uint32_t groupsY, std::uint32_t groupsZ) {
  runPipeline(cachedPipeline(glsl, {}), constants, groupsX, groupsY, groupsZ);
}

std::vector<std::byte> detail::runCompute(const ComputeCall& call) {
  gpu::Context& context = testContext();
  Defines defines = call.options.defines;
  if (!call.inputs.empty()) defines.emplace_back("TEST_HAS_INPUT", "1");
  const std::string glsl = kBefore + call.body + kAfter;
  std::unique_ptr<gpu::ComputePipeline> own;
  if (call.options.set)
    own = std::make_unique<gpu::ComputePipeline>(context, *call.options.set, compileCompute(glsl, defines),
                                                 VkPipelineCache{VK_NULL_HANDLE}, "test");
  const gpu::ComputePipeline& pipeline = own ? *own : cachedPipeline(glsl, defines);

  const gpu::Buffer inputs = gpu::makeBuffer(context, call.inputs, 0, "test inputs");
  const gpu::Buffer outputs(context, {.size = call.count * call.outputSize, .name = "test outputs"});
  const gpu::Buffer sizes = gpu::makeBufferOf(context, std::vector<std::uint32_t>{0, 0}, 0, "test sizes");
  TestBlock block{inputs.address(), outputs.address(), sizes.address(), call.options.addresses, 0, 0};
  block.inputCount = call.inputs.empty() ? 0 : static_cast<std::uint32_t>(call.inputs.size() / call.inputSize);
  gpu::Buffer blockBuffer = gpu::makeBufferOf(context, std::vector<TestBlock>{block}, 0, "test block");
  const Launch launch{call.options.frame, blockBuffer.address()};
  const auto constants = std::as_bytes(std::span(&launch, 1));

  // With count 0 only the sizes are written. A shader with wrong sizes must not write behind the outputs.
  runPipeline(pipeline, constants, 1, 1, 1);
  const auto deviceSizes = sizes.downloadAs<std::uint32_t>(2);
  checkSize("Out", call.outputSize, deviceSizes[0]);
  if (!call.inputs.empty()) checkSize("In", call.inputSize, deviceSizes[1]);

  block.count = static_cast<std::uint32_t>(call.count);
  blockBuffer.uploadAs(std::span<const TestBlock>(&block, 1));
  const std::uint32_t groups = (block.count + kGroupSize - 1) / kGroupSize;
  const std::uint32_t rows = (groups + kRowGroups - 1) / kRowGroups;
  runPipeline(pipeline, constants, std::min(groups, kRowGroups), rows, 1);
  return outputs.downloadAs<std::byte>(call.count * call.outputSize);
}

int runDeviceTests() {
  testing::AddGlobalTestEnvironment(new DeviceEnvironment);
  const int result = RUN_ALL_TESTS();
  // A filter that matches no test is an error.
  return testing::UnitTest::GetInstance()->test_to_run_count() == 0 && !testing::GTEST_FLAG(list_tests) ? 1 : result;
}

}  // namespace quintet::test
