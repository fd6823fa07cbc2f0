// SPDX-License-Identifier: Apache-2.0
#include "output/report.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/diagnostic.h"
#include "base/plural.h"
#include "base/text.h"
#include "check/diagnostic_text.h"
#include "job/printed_line_json.h"
#include "output/json_line.h"

namespace quintet::output {
namespace {

using Json = nlohmann::ordered_json;

Json valueJson(const job::FieldValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag;
  if (const auto* integer = std::get_if<std::uint64_t>(&value)) return *integer;
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* size = std::get_if<uvec2>(&value)) return {size->x, size->y};
  if (const auto* r = std::get_if<render::Region>(&value)) return {r->x, r->y, r->width, r->height};
  if (const auto* p = std::get_if<job::PixelPosition>(&value)) return {p->x, p->y};
  const std::string text = job::toText(value);
  return text.empty() ? Json() : Json(text);
}

// Null if the error is neither known nor limited.
Json errorJson(const job::RenderResult& result) {
  Json json;
  if (result.error.known()) json = {{"image", result.error.upper}, {"tiles", result.error.tiles}};
  if (const std::optional<double> target = result.provenance.targetError) {
    json["target"] = *target;
    json["reached"] = result.error.reaches(*target);
  }
  return json;
}

Json secondsJson(const job::Timings& t, double total) {
  return {{"start", t.start},     {"load", t.load},         {"build", t.build},
          {"compile", t.compile}, {"pipeline", t.pipeline}, {"firstPixel", t.firstPixel},
          {"render", t.render},   {"device", t.device},     {"total", total}};
}

Json framesJson(const std::vector<FrameFiles>& frames) {
  Json list = Json::array();
  for (const FrameFiles& frame : frames) {
    Json files = Json::array();
    for (const std::filesystem::path& file : frame.files) files.push_back(file.string());
    list.push_back({{"frame", frame.frame},
                    {"files", std::move(files)},
                    {"seconds", frame.seconds},
                    {"writtenBefore", frame.written}});
  }
  return list;
}

}  // namespace

std::string printedText(const job::PrintedLine& line) {
  std::string text = fmt::format("{}: pixel {},{}", printable(locationText(line.location.file, line.location.line, 0)),
                                 line.pixel.x, line.pixel.y);
  if (line.frame) text += fmt::format(", frame {}", *line.frame);
  if (line.sample) text += fmt::format(", sample {}", *line.sample);
  std::string_view rest = line.text;
  for (std::string_view separator = ": ";; separator = "\n  ") {
    const std::size_t end = rest.find('\n');
    text.append(separator).append(printable(rest.substr(0, end)));
    if (end == rest.npos) return text;
    rest.remove_prefix(end + 1);
  }
}

std::string printedJson(const job::PrintedLine& line) { return jsonLine({{"print", job::printedLineJson(line)}}); }

std::string resultJson(const job::RenderResult& result, const std::vector<WrittenFile>& files, double totalSeconds,
                       const std::vector<FrameFiles>& frames) {
  const job::MemoryUse& m = result.memory;
  Json json;
  for (const job::ProvenanceField& field : job::provenanceFields())
    if (!field.jsonKey.empty()) json[std::string(field.jsonKey)] = valueJson(field.get(result.provenance));
  json["output"] = files.empty() ? "" : files.back().path.string();
  json["toneMap"] = files.empty() || files.back().toneMap.empty() ? Json() : Json(files.back().toneMap);
  json["files"] = Json::array();
  for (const WrittenFile& file : files) json["files"].push_back(file.path.string());
  if (!frames.empty()) json["frames"] = framesJson(frames);
  json["raysPerSecond"] = result.raysPerSecond();
  json["error"] = errorJson(result);
  json["seconds"] = secondsJson(result.seconds, totalSeconds);
  json["stages"] = Json::object();
  for (const auto& [name, seconds] : result.seconds.stages) json["stages"][name] = seconds;
  json["bytes"] = {{"geometry", m.geometry},
                   {"textures", m.textures},
                   {"accelerationStructures", m.acceleration},
                   {"film", result.filmBytes}};
  json["memory"] = {{"peakHostBytes", m.peakHost},
                    {"peakDeviceBytes", m.peakDevice},
                    {"deviceIsHost", m.deviceIsHost},
                    {"geometryBytes", m.geometry},
                    {"textureBytes", m.textures},
                    {"accelerationBytes", m.acceleration + m.primitiveMaps},
                    {"ratio", m.ratio()}};
  json["devicePeak"] = Json::object();
  for (const auto& [purpose, bytes] : m.devicePeak) json["devicePeak"][purpose + "Bytes"] = bytes;
  if (result.printed) {
    Json lines = Json::array();
    for (const job::PrintedLine& line : result.printed->lines) lines.push_back(job::printedLineJson(line));
    json["printed"] = {{"lines", std::move(lines)}, {"omitted", result.printed->omitted}};
  }
  json["warnings"] = result.warnings;
  json["diagnostics"] = Json::parse(check::diagnosticsJson(result.diagnostics));
  return jsonLine(json);
}

std::string errorJson(const std::string& message, const FileError* file, int exitStatus, const std::string& scene) {
  const auto known = [](const std::string& text) { return text.empty() ? Json() : Json(text); };
  Json json{{"error",
             {{"message", message},
              {"file", file ? known(file->file().string()) : Json()},
              {"location", file ? known(file->location()) : Json()},
              {"exitStatus", exitStatus}}}};
  if (!scene.empty()) json["error"]["scene"] = scene;
  return jsonLine(json);
}

std::string sceneJson(const std::filesystem::path& scene) { return jsonLine({{"scene", scene.string()}}); }

std::string resultSummary(const job::RenderResult& result, const std::vector<WrittenFile>& files,
                          const std::vector<FrameFiles>& frames) {
  const job::Provenance& p = result.provenance;
  std::string file = files.empty() ? "" : files.back().path.string();
  if (files.empty() && !frames.empty() && !frames.back().files.empty()) file = frames.back().files.back().string();
  const std::string rate = p.rays > 0 ? fmt::format(", {:.3g} Mrays/s", result.raysPerSecond() * 1e-6) : "";
  const std::string error = result.error.known() ? fmt::format(", error {:.2g} %", 100.0 * result.error.upper) : "";
  const std::string samples =
      result.accumulatesFrames ? counted(p.samples, "frame") : counted(p.samples, "sample") + " per pixel";
  std::string count;
  if (frames.size() > 1) count = counted(frames.size(), "frame");
  const auto before = std::ranges::count_if(frames, &FrameFiles::written);
  if (before > 0) count += fmt::format(" ({} written before)", before);
  if (!count.empty()) count += ", ";
  return fmt::format("{}: {}{}x{}, {}{}, {}{}{}", file == "-" ? "standard output" : file, count, p.region.width,
                     p.region.height, samples, error, durationText(p.seconds), rate,
                     result.interrupted ? ", interrupted" : "");
}

}  // namespace quintet::output
