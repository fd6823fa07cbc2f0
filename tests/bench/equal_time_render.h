// SPDX-License-Identifier: Apache-2.0
// Runs a quintet binary and measures its cost.
#ifndef QUINTET_TESTS_BENCH_EQUAL_TIME_RENDER_H
#define QUINTET_TESTS_BENCH_EQUAL_TIME_RENDER_H

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace quintet::bench {

struct BenchScene {
  std::string name;
  std::filesystem::path file;
  std::vector<std::string> options;  // of `quintet render`; file names include their folder
};

// Reads a list such as scenes.txt; scene and environment files are in `folder`. Throws FileError.
std::vector<BenchScene> readScenes(const std::filesystem::path& list, const std::filesystem::path& folder);

enum class Clock { device, cpu };

struct RenderCall {
  std::filesystem::path binary;
  const BenchScene* scene = nullptr;
  std::string size;           // WxH
  std::uint64_t samples = 0;  // per pixel; 0 means that `seconds` applies
  double seconds = 0;         // --time; 0 means that `samples` applies
  std::uint32_t seed = 0;
  std::filesystem::path output;   // .exr
  std::vector<std::string> more;  // further options
};

struct RenderCost {
  std::uint64_t samples = 0;  // per pixel
  double deviceSeconds = 0;   // sum of all launches
  double cpuSeconds = 0;      // user and system time of the process
  std::string device;
  double seconds(Clock clock) const { return clock == Clock::device ? deviceSeconds : cpuSeconds; }
};

// Runs the binary and waits for it. Throws Error if it fails.
RenderCost render(const RenderCall& call);

}  // namespace quintet::bench
#endif
