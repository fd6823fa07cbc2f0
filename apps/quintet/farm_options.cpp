#include "farm_options.h"

#include <charconv>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "cli.h"
#include "output.h"
#include "render/film_file.h"
#include "render_options.h"
#include "values.h"

namespace quintet::app {
namespace {

constexpr double kCheckpointSeconds = 60.0;

BatchRange parseBatches(const std::string& text) {
  BatchRange range;
  const char *at = text.data(), *end = at + text.size();
  auto [next, code] = std::from_chars(at, end, range.first);
  range.last = range.first;
  bool right = code == std::errc();
  if (right && next != end) {
    right = *next == '-';
    if (right) {
      const auto second = std::from_chars(next + 1, end, range.last);
      right = second.ec == std::errc() && second.ptr == end && range.first <= range.last;
    }
  }
  if (!right)
    throw UsageError(fmt::format("--batches: '{}' is not A-B with A <= B: batches of {} samples, from 0, B included",
                                 text, render::kBatchSamples));
  return range;
}

void checkBatches(const RenderOptions& options) {
  const BatchRange& range = *options.farm.batches;
  if (options.seconds) throw UsageError("--batches and --time exclude each other: a part is a number of samples");
  if (outputKind(options.output) != OutputKind::film)
    throw UsageError(fmt::format("--batches: a part is written as a film: -o FILE{}", render::kFilmExtension));
  const std::uint64_t count = (*options.samples + render::kBatchSamples - 1) / render::kBatchSamples;
  if (range.last >= count)
    throw UsageError(fmt::format("--batches: {} samples are batches 0-{}, there is no batch {}", *options.samples,
                                 count - 1, range.last));
}

// Also by another name, through a link or "..".
bool sameFile(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code failed;
  if (std::filesystem::equivalent(a, b, failed)) return true;
  const auto resolved = [&](const std::filesystem::path& file) {
    const std::filesystem::path path = std::filesystem::weakly_canonical(std::filesystem::absolute(file), failed);
    return failed ? file.lexically_normal() : path;
  };
  return resolved(a) == resolved(b);
}

void chooseCheckpointFile(RenderOptions& options) {
  FarmOptions& farm = options.farm;
  if (farm.checkpointFile.empty()) {
    if (options.output == "-" || !options.output.has_extension())
      throw UsageError(fmt::format("{}: no name for the checkpoint follows from it; give --checkpoint-file FILE{}",
                                   options.output.string(), render::kFilmExtension));
    farm.checkpointFile = options.output;
    farm.checkpointFile.replace_extension(fmt::format(".checkpoint{}", render::kFilmExtension));
  }
  if (farm.checkpointFile.extension() != render::kFilmExtension)
    throw UsageError(fmt::format("--checkpoint-file: {}: the extension must be {}", farm.checkpointFile.string(),
                                 render::kFilmExtension));
  if (sameFile(farm.checkpointFile, options.output))
    throw UsageError(fmt::format("--checkpoint-file: {} is the output, too", farm.checkpointFile.string()));
}

}  // namespace

void declareFarm(CLI::App& app, FarmOptions& options) {
  const char* group = "Long renderings";
  app.add_option("--checkpoint", options.rawCheckpoint,
                 "Write what is done every so often, 0: after each batch (default with\n--resume, --keep-checkpoint, "
                 "--checkpoint-file: 60); it goes when the\npicture is there")
      ->type_name("SECONDS")
      ->group(group);
  app.add_option("--checkpoint-file", options.checkpointFile, "The checkpoint (default: OUTPUT.checkpoint.qfilm)")
      ->type_name("FILE")
      ->group(group);
  app.add_flag("--keep-checkpoint", options.keepCheckpoint, "Leave it there, complete, when the picture is written")
      ->group(group);
  app.add_flag("--resume", options.resume,
               "Go on from the checkpoint to the same bytes as without the break; begin\nwhere there is none")
      ->group(group);
  app.add_option("--batches", options.rawBatches,
                 "Render only batches A to B of --spp (4 samples each, from 0, B included) into\n-o FILE.qfilm; "
                 "'quintet merge' joins parts")
      ->type_name("A-B")
      ->group(group);
  app.add_flag("--force", options.force, "Overwrite a checkpoint or film that would be lost")->group(group);
  app.add_flag("--json-progress", options.jsonProgress, "A line of JSON on standard error after each batch")
      ->group(group);
}

void interpretFarm(RenderOptions& options) {
  FarmOptions& farm = options.farm;
  if (!farm.rawCheckpoint.empty())
    farm.checkpointSeconds =
        parseNumber("--checkpoint", farm.rawCheckpoint, 0.0, std::numeric_limits<double>::infinity());
  if (farm.resume || farm.keepCheckpoint || !farm.checkpointFile.empty())
    farm.checkpointSeconds = farm.checkpointSeconds.value_or(kCheckpointSeconds);
  if (options.adaptive && !farm.rawBatches.empty())
    throw UsageError(
        "--batches and --adaptive exclude each other: all samples so far decide which come next, and a part does not "
        "know "
        "those of the others");
  if (options.error && !farm.rawBatches.empty())
    throw UsageError("--batches and --until-error exclude each other: a part is a number of samples");
  if (farm.checkpointSeconds) chooseCheckpointFile(options);
  if (farm.rawBatches.empty()) return;
  farm.batches = parseBatches(farm.rawBatches);
  checkBatches(options);
}

}  // namespace quintet::app
