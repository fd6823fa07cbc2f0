// SPDX-License-Identifier: Apache-2.0
// A small Vulkan application with ray tracing, without Quintet's libraries: one instance, one trace, one result per pixel.
// Tests edit its shaders and its calls, and read the messages that it got from VK_EXT_debug_utils.
#ifndef QUINTET_TESTS_LAYER_APPLICATION_H
#define QUINTET_TESTS_LAYER_APPLICATION_H

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace quintet::test {

enum class Modules {
  handles,
  inlined,
  library,
  deferred,
  flags2,      // a library by VkPipelineCreateFlags2CreateInfo, which replaces the flags of the create info
  identifiers  // VK_EXT_shader_module_identifier, with the layer of host_driver.cpp
};
enum class Trace { direct, indirect, indirect2 };

// How the application ends its process: without destroying anything, or destroying all with its static objects.
enum class Exit { no, withoutDestroying, destroysLate };

// What the application does. The defaults are correct.
struct Application {
  // GLSL by file: "a.rgen". A file ".spvasm" is SPIR-V assembly. Two lines precede GLSL, so its first line is line 3.
  std::map<std::string, std::string> shaders;
  struct HitGroup {
    std::string closestHit, anyHit, intersection;  // files; can be empty
  };
  std::vector<std::string> misses{"a.rmiss"}, callables;
  std::vector<HitGroup> hitGroups{{"a.rchit", "", ""}};
  std::vector<std::string> otherGenerations;  // of the pipeline; no trace uses them
  std::uint32_t hitCopies = 1;                // of each hit group, with stages of their own from the same modules
  // More hit groups, each with a module of its own: shader i is "vN.rchit", N = i modulo kVariantTexts, with i for kVariantMark.
  std::uint32_t hitVariants = 0;
  static constexpr std::uint32_t kVariantTexts = 16, kVariantMark = 0x51DE5EED;
  std::uint32_t depth = 1;
  std::map<std::uint32_t, std::uint32_t> constants;  // of ray generation
  Modules modules = Modules::handles;
  bool debugInfo = true;
  std::uint32_t pipelines = 1;  // created by as many threads at the same time; one is used

  bool boxes = false;              // geometry: boxes instead of triangles
  bool opaque = false;             // VK_GEOMETRY_OPAQUE_BIT_KHR
  bool hostBuilds = false;         // vkBuildAccelerationStructuresKHR, with the layer of host_driver.cpp and width 0
  std::uint32_t recordOffset = 0;  // of the instance
  std::uint32_t customIndex = 0;   // of the instance
  std::uint32_t buffers = 0;       // length of an array of buffers in binding 2 of the layout; 0 for no binding
  // The set has fewer buffers than the layout (VARIABLE_DESCRIPTOR_COUNT).
  std::optional<std::uint32_t> setBuffers;
  std::optional<std::uint32_t> stack;  // vkCmdSetRayTracingPipelineStackSizeKHR

  // Shader binding table. Each region starts at a multiple of 256 bytes.
  std::uint32_t recordBytes = 64;                      // stride of miss, hit and callable records
  std::vector<std::uint32_t> missRecords, hitRecords;  // indices of groups; empty for all of the kind in their order
  // Changes the bytes of the table, of which each region has 1024, and the regions: ray generation, miss, hit, callable.
  struct Region {
    std::uint64_t offset = 0, stride = 0, size = 0;
  };
  std::function<void(std::vector<std::byte>& bytes, std::vector<Region>& regions)> editTable;
  std::uint32_t submissions = 1;  // of the same trace; 0 also creates no table
  Trace trace = Trace::direct;    // which command
  std::uint32_t width = 8;        // 0 traces nothing: for tables that crash a driver

  Exit exit = Exit::no;  // with status 0, after the creation of the pipeline

  std::vector<std::string> layers;
};

// An application without mistakes.
Application correctApplication();

struct Message {
  std::string id, text, object;
};
struct RunResult {
  std::vector<Message> messages;    // of the layer under test: ids that start with Q
  std::vector<std::string> others;  // of the validation layers
  std::vector<float> pixels;
  double creationSeconds = 0;       // of the pipeline
  double creationCpuSeconds = 0;    // of the calling thread
  std::uint64_t residentBytes = 0;  // of the process, after the creation of the pipeline
  double firstSeconds = 0;          // of the first submission, from recording to completion
  double traceSeconds = 0;          // of the others
  double recordCpuSeconds = 0;      // of the calling thread, to record and submit them
  std::string error;                // of a Vulkan call; empty if all succeeded
};

RunResult runApplication(const Application& application);

}  // namespace quintet::test
#endif
