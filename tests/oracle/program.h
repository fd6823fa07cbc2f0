// SPDX-License-Identifier: Apache-2.0
// The small programs of the oracle: GLSL stages, one launch, and an array of results.
//
// The header of every stage enables GL_EXT_ray_tracing and scalar layout, declares `tlas`, and contains the `common`
// text of the program, which declares `struct Input` and `struct Output`. Every stage can use
//   launch.inputs.at[i], launch.outputs.at[i], launch.user (uvec4), launch.address[0 … 3],
//   uint launchIndex()      // of this invocation; x varies fastest
// Equal shader texts become one stage.
#ifndef QUINTET_TESTS_ORACLE_PROGRAM_H
#define QUINTET_TESTS_ORACLE_PROGRAM_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "rt/pipeline.h"
#include "scene.h"
#include "shader/compiler.h"

namespace quintet::oracle {

struct HitGroupText {
  std::string closestHit = {}, anyHit = {}, intersection = {};  // empty means none
};

struct ProgramText {
  std::string common;
  std::string rayGeneration;
  std::vector<std::string> miss;
  std::vector<HitGroupText> hit;
  std::vector<std::string> callable = {};
  std::uint32_t recursion = 1;
};

// A record of the shader binding table: the index of a miss shader, hit group or callable shader of the program, and
// its data.
struct Record {
  std::uint32_t shader = 0;
  std::vector<std::byte> data = {};
};
template <class T>
Record recordOf(std::uint32_t shader, const T& data) {
  const auto bytes = std::as_bytes(std::span(&data, 1));
  return {shader, {bytes.begin(), bytes.end()}};
}

struct Table {
  std::vector<Record> miss, hit, callable = {};
};

class Program {
 public:
  explicit Program(const ProgramText& text);
  const rt::Pipeline& pipeline() const { return *pipeline_; }
  Table plainTable() const;  // one record per shader, in order, without data
  rt::SbtContents contents(const Table& table) const;
  static gpu::BindlessSet& set();  // descriptors and push constants of all programs

 private:
  std::uint32_t missCount_, hitCount_, callableCount_;
  std::unique_ptr<rt::Pipeline> pipeline_;
};

// Calls `destroy` after the last test, before the device is destroyed, in reverse order of registration.
void atEnd(std::function<void()> destroy);

// Compiles one stage with the header.
std::vector<std::uint32_t> compileStage(shader::Stage stage, const std::string& common, const std::string& text);

// Push constants of all programs: `launch` in GLSL.
struct LaunchConstants {
  VkDeviceAddress inputs = 0, outputs = 0;
  std::array<VkDeviceAddress, 4> addresses{};
  uvec4 user{0};
};

struct LaunchOptions {
  uvec3 size{0};            // 0 means one invocation per input
  std::size_t outputs = 0;  // 0 means one per invocation
  uvec4 user{0};
  std::array<VkDeviceAddress, 4> addresses{};
  const Table* table = nullptr;  // null means plainTable()
};

namespace detail {
std::vector<std::byte> launch(const Program& program, VkAccelerationStructureKHR tlas,
                              std::span<const std::byte> inputs, std::size_t inputCount, std::size_t outputSize,
                              const LaunchOptions& options);
}  // namespace detail

// Runs a program. Its outputs are zero before the launch.
template <class Out, class In>
std::vector<Out> run(const Program& program, VkAccelerationStructureKHR tlas, const std::vector<In>& inputs,
                     const LaunchOptions& options = {}) {
  static_assert(std::is_trivially_copyable_v<Out> && std::is_trivially_copyable_v<In>);
  const std::vector<std::byte> bytes =
      detail::launch(program, tlas, std::as_bytes(std::span(inputs)), inputs.size(), sizeof(Out), options);
  std::vector<Out> result(bytes.size() / sizeof(Out));
  std::memcpy(result.data(), bytes.data(), bytes.size());
  return result;
}
template <class Out, class In>
std::vector<Out> run(const Program& program, const Scene& scene, const std::vector<In>& inputs,
                     const LaunchOptions& options = {}) {
  return run<Out>(program, scene.handle(), inputs, options);
}

}  // namespace quintet::oracle
#endif
