// SPDX-License-Identifier: Apache-2.0
// Harness of the device tests: one Context per process, and functions of the shader library that run in compute shaders
// and map vectors to vectors.
//
//   struct In { float roughness; vec3 wo; };                 // C++: the same bytes as GLSL's scalar layout
//   const std::vector<In> inputs = …;
//   const std::vector<vec3> wi = test::runCompute<vec3>(R"(
//     #include <quintet/bsdf/ggx.glsl>
//     struct In { float roughness; vec3 wo; };
//     #define Out vec3
//     Out run(uint index, In value) { return ggxSample(value.wo, value.roughness, randomAt(index)); }
//   )", inputs, 1'000'000);                                  // invocation i gets inputs[i % inputs.size()]
//
// `input` and `output` are reserved words of GLSL. If the sizes of In or Out differ between C++ and GLSL, the error
// states both. Lines in compile errors count from the first line of the body.
#ifndef QUINTET_TESTS_GPU_HARNESS_H
#define QUINTET_TESTS_GPU_HARNESS_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "gpu/compute.h"

namespace quintet::test {

inline constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

// Returns the device of this process ($QUINTET_DEVICE), which the first call creates; with validation if
// $QUINTET_VALIDATE is set. Throws NoDeviceError.
gpu::Context& testContext();

// Collects the messages of the validation layer of any device; they make the run fail at the end.
LogSink testLog();

// RUN_ALL_TESTS, then destroys the device. Fails for validation messages and if no test runs.
int runDeviceTests();

// The default descriptor set of shaders: no TLAS, no textures, 128 bytes of push constants.
const gpu::BindlessSet& testSet();

// Folder of compiled shaders, in cacheFolder(). The entries depend on the contents of all sources, so the processes of a test
// run share it ($QUINTET_CACHE_DIR in CMakePresets.json).
std::filesystem::path shaderCache();

using Defines = std::vector<std::pair<std::string, std::string>>;

// Compiles a complete compute shader, which can include the shader library. Throws an exception with the diagnostics.
std::vector<std::uint32_t> compileCompute(const std::string& glsl, const Defines& defines = {});

// Runs a complete compute shader and waits. `constants` (at most 128 bytes) are its push constants, for example a
// struct of buffer addresses.
void dispatchCompute(const std::string& glsl, std::span<const std::byte> constants, std::uint32_t groupsX,
                     std::uint32_t groupsY = 1, std::uint32_t groupsZ = 1);

struct ComputeOptions {
  Defines defines = {};
  const gpu::BindlessSet* set = nullptr;       // for textures; at least 32 bytes of push constants
  VkDeviceAddress frame = 0;                   // launch.frameAddress of <quintet/frame.glsl>
  std::array<VkDeviceAddress, 8> addresses{};  // values of testAddress(0) … testAddress(7) in GLSL
};

namespace detail {
struct ComputeCall {
  const std::string& body;
  std::span<const std::byte> inputs;  // empty if the body defines run(uint index)
  std::size_t inputSize;              // bytes per input
  std::size_t outputSize;             // bytes per output
  std::size_t count;                  // invocations
  const ComputeOptions& options;
};
std::vector<std::byte> runCompute(const ComputeCall& call);

template <class Out>
std::vector<Out> runComputeAs(const ComputeCall& call) {
  static_assert(std::is_trivially_copyable_v<Out> && sizeof(Out) % 4 == 0);
  const std::vector<std::byte> bytes = runCompute(call);
  std::vector<Out> result(call.count);
  std::memcpy(result.data(), bytes.data(), bytes.size());
  return result;
}
}  // namespace detail

// Runs `Out run(uint index, In value)` of `body` for index 0 … count-1 and returns the results.
template <class Out, class In>
std::vector<Out> runCompute(const std::string& body, const std::vector<In>& inputs, std::size_t count,
                            const ComputeOptions& options = {}) {
  static_assert(std::is_trivially_copyable_v<In> && sizeof(In) % 4 == 0);
  if (inputs.empty()) throw std::invalid_argument("runCompute: no inputs");
  return detail::runComputeAs<Out>({body, std::as_bytes(std::span(inputs)), sizeof(In), sizeof(Out), count, options});
}

// One invocation per input.
template <class Out, class In>
std::vector<Out> runCompute(const std::string& body, const std::vector<In>& inputs) {
  return runCompute<Out>(body, inputs, inputs.size());
}

// Runs `Out run(uint index)` of `body`.
template <class Out>
std::vector<Out> runCompute(const std::string& body, std::size_t count, const ComputeOptions& options = {}) {
  return detail::runComputeAs<Out>({body, {}, 0, sizeof(Out), count, options});
}

}  // namespace quintet::test
#endif
