#include "metadata.h"

#include <cmath>

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "diagnostics_view.h"
#include "values.h"

namespace quintet::app {
namespace {

std::string regionText(const RenderRecord& record) {
  return fmt::format("{},{},{},{}", record.region[0], record.region[1], record.region[2], record.region[3]);
}

nlohmann::ordered_json memoryJson(const MemoryUse& memory) {
  return {{"peakHostBytes", memory.peakHost},
          {"peakDeviceBytes", memory.peakDevice},
          {"deviceIsHost", memory.deviceIsHost},
          {"geometryBytes", memory.geometry},
          {"textureBytes", memory.textures},
          {"accelerationBytes", memory.acceleration},
          {"ratio", memory.ratio()}};
}

nlohmann::ordered_json devicePeakJson(const MemoryUse& memory) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [purpose, bytes] : memory.devicePeak) json[purpose + "Bytes"] = bytes;
  return json;
}

nlohmann::ordered_json errorJson(const RenderRecord& record) {
  nlohmann::ordered_json json;  // null: neither known nor asked for
  if (record.error.known()) json = {{"image", record.error.upper}, {"tiles", record.error.tiles}};
  if (record.wantedError) {
    json["wanted"] = *record.wantedError;
    json["reached"] = record.error.reaches(*record.wantedError);
  }
  return json;
}

}  // namespace

double MemoryUse::ratio() const {
  const std::uint64_t needed = geometry + textures + acceleration;
  const std::uint64_t peak = deviceIsHost ? peakHost : std::max(peakHost, peakDevice);
  return needed > 0 ? static_cast<double>(peak) / static_cast<double>(needed) : 0.0;
}

io::Metadata metadata(const RenderRecord& record) {
  io::Metadata data{
      {"Software", "quintet " QUINTET_VERSION},
      {"Command", record.commandLine},
      {"Scene", record.scene},
      {"SceneHash", record.sceneHash},
      {"Environment", record.environment},
      {"Camera", record.camera},
      {"Program", record.program},
      {"Output", record.outputName},
      {"Parameters", record.parameters},
      {"Seed", fmt::format("{}", record.seed)},
      {"Samples", fmt::format("{}", record.samples)},
      {"Size", fmt::format("{}x{}", record.width, record.height)},
  };
  if (record.frame) data.emplace_back("Frame", fmt::format("{}", *record.frame));
  if (record.cropped()) data.emplace_back("Region", regionText(record));
  if (!record.toneMap.empty()) {
    data.emplace_back("ToneMap", record.toneMap);
    data.emplace_back("Exposure", fmt::format("{}", record.exposure));
  }
  data.emplace_back("Device", record.device);
  data.emplace_back("Driver", record.driver);
  data.emplace_back("Seconds", fmt::format("{:.3f}", record.renderSeconds));
  data.emplace_back("Rays", fmt::format("{}", record.rays));
  if (record.droppedSamples > 0) data.emplace_back("DroppedSamples", fmt::format("{}", record.droppedSamples));
  if (record.adaptive) data.emplace_back("Adaptive", "yes");
  if (record.error.known()) {
    data.emplace_back("Error", fmt::format("{:.6g}", record.error.upper));
    data.emplace_back("TileError", fmt::format("{:.6g}", record.error.tiles));
  }
  if (record.interrupted) data.emplace_back("Interrupted", "yes");
  return data;
}

std::string unreachedText(const RenderRecord& record) {
  const std::string wanted = fmt::format("the error of {:.2g} % was not reached", 100.0 * *record.wantedError);
  if (record.samples <= render::kBatchSamples) return wanted + ": it is not known below two batches of samples";
  if (!record.error.known()) return wanted + ": it is not known, some pixels are beyond the range of the film's sums";
  return fmt::format("{}: it is {:.2g} %, in 95 % of the tiles at most {:.2g} %", wanted, 100.0 * record.error.upper,
                     100.0 * record.error.tiles);
}

std::string toJson(const RenderRecord& record) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::object();
  for (const auto& [name, seconds] : record.stages) stages[name] = seconds;
  const nlohmann::ordered_json json{
      {"version", QUINTET_VERSION},
      {"command", record.commandLine},
      {"output", record.files.empty() ? "" : record.files.back()},
      {"files", record.files},
      {"scene", record.scene},
      {"sceneHash", record.sceneHash},
      {"environment", record.environment},
      {"camera", record.camera},
      {"program", record.program},
      {"parameters", record.parameters},
      {"size", {record.width, record.height}},
      {"region", {record.region[0], record.region[1], record.region[2], record.region[3]}},
      {"transparent", record.transparent},
      {"toneMap", record.toneMap.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(record.toneMap)},
      {"exposure", record.exposure},
      {"seed", record.seed},
      {"samples", record.samples},
      {"frame", record.frame ? nlohmann::ordered_json(*record.frame) : nlohmann::ordered_json()},
      {"rays", record.rays},
      {"raysPerSecond", record.raysPerSecond()},
      {"droppedSamples", record.droppedSamples},
      {"interrupted", record.interrupted},
      {"adaptive", record.adaptive},
      {"error", errorJson(record)},
      {"device", record.device},
      {"driver", record.driver},
      {"seconds",
       {{"start", record.startSeconds},
        {"load", record.loadSeconds},
        {"build", record.buildSeconds},
        {"compile", record.compileSeconds},
        {"pipeline", record.pipelineSeconds},
        {"firstPixel", record.firstPixelSeconds},
        {"render", record.renderSeconds},
        {"device", record.deviceSeconds},
        {"total", record.totalSeconds}}},
      {"stages", std::move(stages)},
      {"bytes",
       {{"geometry", record.geometryBytes},
        {"textures", record.textureBytes},
        {"accelerationStructures", record.accelerationBytes},
        {"film", record.filmBytes}}},
      {"memory", memoryJson(record.memory)},
      {"devicePeak", devicePeakJson(record.memory)},
      {"warnings", record.warnings},
      {"diagnostics", nlohmann::ordered_json::parse(diagnosticsJson(record.diagnostics))},
  };
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string summary(const RenderRecord& record) {
  const std::string file = record.files.empty() ? "" : record.files.back();
  const std::string rate = record.rays > 0 ? fmt::format(", {:.3g} Mrays/s", record.raysPerSecond() * 1e-6) : "";
  const std::string error = record.error.known() ? fmt::format(", error {:.2g} %", 100.0 * record.error.upper) : "";
  return fmt::format("{}: {}x{}, {} {}{}, {}{}{}", file == "-" ? "standard output" : file, record.region[2],
                     record.region[3], record.samples,
                     !record.accumulates   ? "samples per pixel"
                     : record.samples == 1 ? "frame"
                                           : "frames",
                     error, durationText(record.renderSeconds), rate, record.interrupted ? ", interrupted" : "");
}

}  // namespace quintet::app
