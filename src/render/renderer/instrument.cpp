// SPDX-License-Identifier: Apache-2.0
#include "render/renderer/instrument.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string_view>
#include <tuple>

#include "base/plural.h"

namespace quintet::render {
namespace {

std::string vectorText(const vec3& v) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z); }

// Returns the file of a stage in the form that its author wrote: with the lecture form, one file for all stages.
std::string sourceFile(const program::Program& program, const std::string& stage) {
  return stage.starts_with(program.descriptionFile + ".") ? program.descriptionFile : stage;
}

// The call that a report is about, or the end of its name.
std::string_view callOf(const shared::InstrumentReport& report) {
  switch (report.kind) {
    case shared::kReportCall: return "executeCallableEXT";
    case shared::kReportOutput: return "Output";  // storeOutput, addOutput
    default: return "traceRayEXT";
  }
}

// Returns `line` if a call of this name in the file covers it. Otherwise the call is in an included file, whose line
// numbers do not apply to this file, and the result is 0.
int callLine(const program::Program& program, const std::string& file, std::uint32_t line, std::string_view call) {
  const auto found = program.files.find(file);
  if (found == program.files.end() || line == 0) return 0;
  const std::string& text = found->second;
  std::size_t begin = 0;
  for (std::uint32_t k = 1; k < line; ++k) {
    begin = text.find('\n', begin);
    if (begin == std::string::npos) return 0;
    ++begin;
  }
  const std::size_t at = text.rfind(call, text.find('\n', begin));
  if (at == std::string::npos) return 0;
  const bool endsBefore = at < begin && text.find(';', at) < begin;
  return endsBefore ? 0 : static_cast<int>(line);
}

std::string describe(const shared::InstrumentReport& report, const shared::Instrument& counts,
                     const program::Program& program) {
  const std::string where = fmt::format("pixel {}, {}, depth {}", report.pixel.x, report.pixel.y, report.depth);
  switch (report.kind) {
    case shared::kReportRay:
      return fmt::format("the ray is invalid: origin {}, direction {} ({})", vectorText(report.origin),
                         vectorText(report.direction), where);
    case shared::kReportMiss:
      return fmt::format("miss index {} is beyond the {} miss shaders of the table; the trace was not executed ({})",
                         report.index, counts.missCount, where);
    case shared::kReportCall:
      return fmt::format("callable index {} is beyond the {} of the table; the call was not executed ({})",
                         report.index, counted(counts.callableCount, "callable shader"), where);
    case shared::kReportOutput:
      if (report.index >= program.outputs.size())
        return fmt::format("output {} does not exist: the program has {}; nothing was stored (pixel {}, {})",
                           report.index, counted(program.outputs.size(), "output"), report.pixel.x, report.pixel.y);
      return fmt::format(
          "output '{}' is stored at {}, {} of the film, which is outside; nothing was stored (pixel {}, {})",
          program.outputs[report.index].name, report.origin.x, report.origin.y, report.pixel.x, report.pixel.y);
    case shared::kReportDepth:
      return fmt::format("this trace exceeds the recursion depth of the pipeline; it was not executed ({})", where);
    default:
      return fmt::format(
          "the ray hits the primitive that it starts on at distance {:.3g}, which is less than the rounding error of "
          "its "
          "origin {} ({})",
          report.distance, vectorText(report.origin), where);
  }
}

// Adds the reports, one diagnostic for each kind and source location.
void addReports(const InstrumentData& data, const program::RunnableProgram& runnable, std::vector<Diagnostic>& result) {
  const program::Program& program = runnable.description;
  struct Location {
    std::uint32_t count = 0;
    shared::InstrumentReport first;
  };
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, Location> locations;
  for (std::uint32_t i = 0; i < std::min(data.counts.reportCount, shared::kInstrumentReports); ++i) {
    const shared::InstrumentReport& report = data.reports[i];
    Location& location = locations[{report.kind, report.stage, report.line}];
    if (location.count++ == 0) location.first = report;
  }
  for (const auto& [key, location] : locations) {
    const shared::InstrumentReport& first = location.first;
    const std::vector<program::CompiledProgram::Stage>& stages = runnable.compiled.stages;
    const std::string file =
        sourceFile(program, first.stage < stages.size() ? stages[first.stage].file : program.rayGeneration);
    std::string text = describe(first, data.counts, program);
    if (location.count > 1)
      text += fmt::format("; {}{} such {}", data.counts.reportCount > shared::kInstrumentReports ? "at least " : "",
                          location.count,
                          first.kind == shared::kReportCall     ? "calls"
                          : first.kind == shared::kReportOutput ? "stores"
                                                                : "traces");
    result.push_back({first.kind == shared::kReportSelfHit ? Severity::warning : Severity::error, program.path(file),
                      callLine(program, file, first.line, callOf(first)), 0, fmt::format("Q00{}", first.kind % 16),
                      text});
  }
}

// Adds a diagnostic Q004 for each combination of offset and stride that exceeds the hit records of the table.
void addRecords(const shared::Instrument& counts, const program::Program& program, const program::SceneFacts& facts,
                std::vector<Diagnostic>& result) {
  const auto rays = static_cast<std::uint32_t>(program.rays.size());
  const std::uint64_t records = std::uint64_t{facts.geometries.size()} * rays;
  const std::string file = program.path(sourceFile(program, program.rayGeneration));
  for (std::uint32_t pair = 0; pair < 256; ++pair) {
    if ((counts.recordPairs[pair / 32] >> (pair % 32) & 1u) == 0) continue;
    const std::uint32_t offset = pair % 16, stride = pair / 16;
    for (const program::InstanceFacts& instance : facts.instances) {
      if (instance.geometryCount == 0) continue;
      const std::uint64_t record =
          std::uint64_t{instance.firstGeometry} * rays + std::uint64_t{instance.geometryCount - 1} * stride + offset;
      if (record < records) continue;
      result.push_back(
          {Severity::error, file, 0, 0, "Q004",
           fmt::format(
               "a trace with offset {} and stride {} uses hit record {} for instance '{}', but the table has {}",
               offset, stride, record, instance.name, records)});
      break;
    }
  }
}

}  // namespace

InstrumentBuffer::InstrumentBuffer(gpu::Context& context, std::uint64_t pixels, std::uint32_t depthLimit,
                                   const program::Program& program) {
  std::vector<std::byte> bytes(sizeof(InstrumentData) + pixels * sizeof(shared::InstrumentPixel));
  auto& header = *reinterpret_cast<shared::Instrument*>(bytes.data());
  header.pixelCount = static_cast<std::uint32_t>(pixels);
  header.depthLimit = depthLimit;
  header.missCount = static_cast<std::uint32_t>(program::missShaders(program).size());
  header.callableCount = static_cast<std::uint32_t>(program.callables.size());
  buffer_ = gpu::makeBuffer(context, bytes, 0, "instrument");
}

InstrumentData InstrumentBuffer::download() const {
  InstrumentData data;
  buffer_.download(std::as_writable_bytes(std::span(&data, 1)));
  return data;
}

// Invocations of a launch: the pixels of the film, or those of its tiles. Ray generation shaders set the depth before they
// trace, so only the header is initialized.
RecursionBuffer::RecursionBuffer(gpu::Context& context, const Region& region, std::uint32_t depthLimit) {
  const std::uint64_t invocations = std::max(std::uint64_t{region.width} * region.height,
                                             std::uint64_t{tileCount(region)} * shared::kTileSize * shared::kTileSize);
  buffer_ = gpu::Buffer(
      context, {.size = sizeof(shared::RecursionGuard) + invocations * sizeof(std::uint32_t), .name = "recursion"});
  const shared::RecursionGuard header{0, depthLimit};
  buffer_.uploadAs(std::span(&header, 1));
}

std::uint32_t RecursionBuffer::skippedTraces() const {
  return buffer_.downloadAs<shared::RecursionGuard>(1).front().cutCount;
}

std::vector<Diagnostic> instrumentDiagnostics(const InstrumentData& data, const program::RunnableProgram& runnable,
                                              const program::SceneFacts& facts) {
  std::vector<Diagnostic> result;
  const program::Program& program = runnable.description;
  const shared::Instrument& counts = data.counts;
  addReports(data, runnable, result);
  addRecords(counts, program, facts, result);
  if (counts.anyHitCount > 0)
    result.push_back(
        {Severity::note, program.path(sourceFile(program, program.rayGeneration)), 0, 0, "Q006",
         fmt::format("{} any-hit shader calls for {} traces; {:.2f} per pixel, at most {} in one pixel",
                     counts.anyHitCount, counts.traceCount,
                     static_cast<double>(counts.anyHitCount) / std::max(1u, counts.pixelCount), counts.mostAnyHits)});
  return result;
}

std::vector<Diagnostic> outputDiagnostics(const program::Program& description, const Film& film) {
  std::vector<Diagnostic> result;
  const std::string file = description.path(sourceFile(description, description.rayGeneration));
  for (std::size_t output = 0; output < description.outputs.size(); ++output) {
    if (!film.stores(output) || description.outputs[output].pixel == program::OutputPixel::coverage) continue;
    const io::Image image = film.download(output);
    const std::span<const float> values = image.samples<float>();
    const auto bad = std::ranges::find_if_not(values, [](float v) { return std::isfinite(v); });
    if (bad == values.end()) continue;
    const auto count = std::ranges::count_if(values, [](float v) { return !std::isfinite(v); });
    const auto pixel = static_cast<std::uint64_t>(bad - values.begin()) / 4;
    result.push_back({Severity::error, file, 0, 0, "Q002",
                      fmt::format("output '{}' is {} at pixel {}, {}; {} not finite", description.outputs[output].name,
                                  *bad, film.region().x + pixel % image.width, film.region().y + pixel / image.width,
                                  count == 1 ? "1 value is" : fmt::format("{} values are", count))});
  }
  if (const RayCount count = film.countRays(); count.droppedSamples > 0)
    result.push_back(
        {Severity::error, file, 0, 0, "Q002",
         fmt::format("{} not finite; the program dropped {}; the first is at pixel {}, {}",
                     count.droppedSamples == 1 ? "1 sample was" : fmt::format("{} samples were", count.droppedSamples),
                     count.droppedSamples == 1 ? "it" : "them", count.firstDropped.x, count.firstDropped.y)});
  return result;
}

}  // namespace quintet::render
