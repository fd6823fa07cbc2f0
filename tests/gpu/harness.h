// What every device test needs: one Context per process, and functions of the shader library run in
// compute shaders, from vectors to vectors.
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
// `input` and `output` are reserved words of GLSL. Sizes of In and Out that differ between C++ and GLSL
// are an error that says both. Lines in compile errors count from the body's first line.
#ifndef QUINTET_TESTS_GPU_HARNESS_H
#define QUINTET_TESTS_GPU_HARNESS_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "gpu/compute.h"

namespace quintet::test {

// The device of this process ($QUINTET_DEVICE), made at the first call; validated if $QUINTET_VALIDATE is
// set. Throws NoDeviceError: the test fails. Its validation messages fail the run at the end.
gpu::Context& testContext();

// RUN_ALL_TESTS with the device torn down at the end; validation messages, or no test at all, are failures.
int runDeviceTests();

// The set that shaders run with unless they are given one: no TLAS, no textures, 128 bytes of constants.
const gpu::BindlessSet& testSet();

using Defines = std::vector<std::pair<std::string, std::string>>;

// SPIR-V of a whole compute shader; #include finds the shader library. Throws with the diagnostics.
std::vector<std::uint32_t> compileCompute(const std::string& glsl, const Defines& defines = {});

// Runs a whole compute shader and waits for it. `constants` (128 bytes at most) are its push constants,
// e.g. a struct of buffer addresses.
void dispatchCompute(const std::string& glsl, std::span<const std::byte> constants, std::uint32_t groupsX,
                     std::uint32_t groupsY = 1, std::uint32_t groupsZ = 1);

struct ComputeOptions {
  Defines defines = {};
  const gpu::BindlessSet* set = nullptr;       // for textures; at least 32 bytes of push constants
  VkDeviceAddress frame = 0;                   // launch.frame of <quintet/frame.glsl>
  std::array<VkDeviceAddress, 8> addresses{};  // what testAddress(0) … testAddress(7) return in GLSL
};

namespace detail {
struct ComputeCall {
  const std::string& body;
  std::span<const std::byte> inputs;  // empty: the body defines run(uint index)
  std::size_t inputSize;              // bytes of one
  std::size_t outputSize;             // bytes of one
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

// Runs `Out run(uint index, In value)` of `body` for index 0 … count-1 and returns what it returned.
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
