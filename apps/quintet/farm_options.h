// Options of renderings that last long or are shared by machines: checkpoints, going on, parts.
#ifndef QUINTET_APP_FARM_OPTIONS_H
#define QUINTET_APP_FARM_OPTIONS_H

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace quintet::app {

struct RenderOptions;

// Batches of render::kBatchSamples samples, both ends included, from 0.
struct BatchRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

struct FarmOptions {
  std::optional<double> checkpointSeconds;  // nothing: no checkpoints; 0: after every batch
  std::filesystem::path checkpointFile;     // empty: no checkpoints
  bool keepCheckpoint = false;
  bool resume = false;
  bool force = false;  // what would be lost may be
  bool jsonProgress = false;
  std::optional<BatchRange> batches;

  // As text.
  std::string rawCheckpoint, rawBatches;
};

void declareFarm(CLI::App& app, FarmOptions& options);
// Checks them and fills in what follows from the other options. Throws UsageError.
void interpretFarm(RenderOptions& options);

}  // namespace quintet::app
#endif
