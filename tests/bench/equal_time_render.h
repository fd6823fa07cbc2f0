// One call of a quintet binary, and what it cost.
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
  std::vector<std::string> options;  // of `quintet render`; files among them with their folder
};

// The lines of a list like scenes.txt; scenes and skies lie in `folder`. Throws FileError.
std::vector<BenchScene> readScenes(const std::filesystem::path& list, const std::filesystem::path& folder);

enum class Clock { device, cpu };

struct RenderCall {
  std::filesystem::path binary;
  const BenchScene* scene = nullptr;
  std::string size;           // WxH
  std::uint64_t samples = 0;  // per pixel; 0: `seconds`
  double seconds = 0;         // --time
  std::uint32_t seed = 0;
  std::filesystem::path output;   // .exr
  std::vector<std::string> more;  // further options
};

struct RenderCost {
  std::uint64_t samples = 0;  // per pixel
  double deviceSeconds = 0;   // on the device, of all launches
  double cpuSeconds = 0;      // user and system time of the process
  std::string device;
  double seconds(Clock clock) const { return clock == Clock::device ? deviceSeconds : cpuSeconds; }
};

// Runs it and waits. Throws Error if it fails or says nothing.
RenderCost render(const RenderCall& call);

}  // namespace quintet::bench
#endif
