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
#include "render/renderer/trace_location.h"

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

// What is wrong with a ray (kReportRay).
std::string_view problemOf(const shared::InstrumentReport& ray) {
  const auto finite = [](const vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
  if (!finite(ray.origin)) return "its origin is not finite";
  if (!finite(ray.direction)) return "its direction is not finite";
  if (ray.direction == vec3(0)) return "its direction is 0";
  if (std::isnan(ray.interval.x) || std::isnan(ray.interval.y)) return "its interval is not a number";
  return ray.interval.x < 0 ? "tmin is negative" : "tmin is greater than tmax";
}

// The first instance that uses a hit record beyond the table with an offset and a stride (offset + 16 * stride).
struct BadRecord {
  const program::InstanceFacts* instance = nullptr;  // null if there is none
  std::uint64_t record = 0;
};

BadRecord findBadRecord(std::uint32_t pair, const program::SceneFacts& facts, std::size_t rayCount, auto&& visit) {
  const std::uint32_t offset = pair % 16, stride = pair / 16;
  for (const program::InstanceFacts& instance : facts.instances) {
    if (instance.geometryCount == 0) continue;
    const std::uint64_t record =
        std::uint64_t{instance.firstGeometry} * rayCount + std::uint64_t{instance.geometryCount - 1} * stride + offset;
    if (record >= std::uint64_t{facts.geometries.size()} * rayCount && visit(instance)) return {&instance, record};
  }
  return {};
}

std::string describeRecord(std::uint32_t pair, const program::SceneFacts& facts, std::size_t rayCount) {
  const BadRecord bad = findBadRecord(pair, facts, rayCount, [](const auto&) { return true; });
  return fmt::format(
      "with offset {} and stride {}, this trace uses hit record {} for instance '{}', but the table has {}", pair % 16,
      pair / 16, bad.record, bad.instance ? bad.instance->name : "", facts.geometries.size() * rayCount);
}

std::string describe(const shared::InstrumentReport& report, const shared::Instrument& counts,
                     const program::Program& program) {
  const std::string where = fmt::format("pixel {}, {}, depth {}", report.pixel.x, report.pixel.y, report.depth);
  switch (report.kind) {
    case shared::kReportRay:
      return fmt::format("the ray is invalid, because {}: origin {}, direction {}, t in [{:g}, {:g}] ({})",
                         problemOf(report), vectorText(report.origin), vectorText(report.direction), report.interval.x,
                         report.interval.y, where);
    case shared::kReportMiss:
      return fmt::format("miss index {} is beyond the {} of the table; the trace was not executed ({})", report.index,
                         counted(counts.missCount, "miss shader"), where);
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
void addReports(const InstrumentData& data, const program::RunnableProgram& runnable, const program::SceneFacts& facts,
                std::vector<Diagnostic>& result) {
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
    std::string text = first.kind == shared::kReportRecord
                           ? fmt::format("{}; it was not executed (pixel {}, {}, depth {})",
                                         describeRecord(first.index, facts, program.rays.size()), first.pixel.x,
                                         first.pixel.y, first.depth)
                           : describe(first, data.counts, program);
    if (location.count > 1)
      text += fmt::format("; {}{} such {}", data.counts.reportCount > shared::kInstrumentReports ? "at least " : "",
                          location.count,
                          first.kind == shared::kReportCall     ? "calls"
                          : first.kind == shared::kReportOutput ? "stores"
                                                                : "traces");
    const std::string_view call = callOf(first);
    SourceLocation at = call == "traceRayEXT" ? traceLocation(runnable, first.stage, first.line) : SourceLocation{};
    if (at.line == 0) at = {program.path(file), callLine(program, file, first.line, call), 0};
    result.push_back({first.kind == shared::kReportSelfHit ? Severity::warning : Severity::error,
                      at.file,
                      at.line,
                      at.column,
                      fmt::format("Q00{}", first.kind % 16),
                      text,
                      {}});
  }
}

// Adds the reports of hit records that were only counted.
void addRecords(const InstrumentData& data, const program::Program& program, const program::SceneFacts& facts,
                std::vector<Diagnostic>& result) {
  const std::uint32_t stored = std::min(data.counts.reportCount, shared::kInstrumentReports);
  for (std::uint32_t pair = 0; pair < 256; ++pair) {
    if ((data.counts.recordPairs[pair / 32] >> (pair % 32) & 1u) == 0) continue;
    const bool known =
        std::ranges::any_of(std::span(data.reports, stored), [&](const shared::InstrumentReport& report) {
          return report.kind == shared::kReportRecord && report.index == pair;
        });
    if (!known)
      result.push_back({Severity::error, program.path(sourceFile(program, program.rayGeneration)), 0, 0, "Q004",
                        describeRecord(pair, facts, program.rays.size())});
  }
}

}  // namespace

InstrumentBuffer::InstrumentBuffer(gpu::Context& context, std::uint64_t pixels, std::uint32_t depthLimit,
                                   const program::Program& program, const program::SceneFacts& facts) {
  std::vector<std::byte> bytes(sizeof(InstrumentData) + pixels * sizeof(shared::InstrumentPixel));
  auto& header = *reinterpret_cast<shared::Instrument*>(bytes.data());
  header.pixelCount = static_cast<std::uint32_t>(pixels);
  header.depthLimit = depthLimit;
  header.missCount = static_cast<std::uint32_t>(program::missShaders(program).size());
  header.callableCount = static_cast<std::uint32_t>(program.callables.size());
  header.outputCount = static_cast<std::uint32_t>(program.outputs.size());
  for (std::uint32_t pair = 0; pair < 256; ++pair)
    findBadRecord(pair, facts, program.rays.size(), [&](const program::InstanceFacts& instance) {
      header.badRecords[pair / 4] |= (instance.mask & 0xFFu) << (8 * (pair % 4));
      return false;
    });
  buffer_ = gpu::makeBuffer(context, bytes, 0, "instrument");
}

InstrumentData InstrumentBuffer::download() const {
  InstrumentData data;
  buffer_.download(std::as_writable_bytes(std::span(&data, 1)));
  return data;
}

// Invocations of a launch: the rows of the image up to the end of the film, or the pixels of its tiles. Ray generation shaders set the depth before they
// trace, so only the header is initialized.
RecursionBuffer::RecursionBuffer(gpu::Context& context, const Region& region) {
  const std::uint64_t invocations = std::max(std::uint64_t{region.width} * (region.y + region.height),
                                             std::uint64_t{tileCount(region)} * shared::kTileSize * shared::kTileSize);
  buffer_ = gpu::Buffer(
      context, {.size = sizeof(shared::RecursionGuard) + invocations * sizeof(std::uint32_t), .name = "recursion"});
  const shared::RecursionGuard header{0};
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
  addReports(data, runnable, facts, result);
  addRecords(data, program, facts, result);
  if (counts.anyHitCount > 0)
    result.push_back(
        {Severity::note, program.path(sourceFile(program, program.rayGeneration)), 0, 0, "Q006",
         fmt::format("{} for {}; {:.2f} per pixel, at most {} in one pixel",
                     counted(counts.anyHitCount, "any-hit shader call"), counted(counts.traceCount, "trace"),
                     static_cast<double>(counts.anyHitCount) / std::max(1u, counts.pixelCount), counts.mostAnyHits)});
  return result;
}

std::vector<Diagnostic> outputDiagnostics(const program::Program& description, const Film& film) {
  std::vector<Diagnostic> result;
  const std::string file = description.path(sourceFile(description, description.rayGeneration));
  for (const NotFinitePixels& pixels : film.notFinitePixels())
    result.push_back(
        {Severity::error, file, 0, 0, "Q002",
         fmt::format("output '{}' is not finite at pixel {}, {}", pixels.output, pixels.first.x, pixels.first.y) +
             (pixels.count == 1 ? "" : fmt::format("; {} such pixels", pixels.count))});
  if (const RayCount count = film.countRays(); count.droppedSamples > 0)
    result.push_back(
        {Severity::error, file, 0, 0, "Q002",
         fmt::format("{} {} not finite; the program dropped {}; the first is at pixel {}, {}",
                     counted(count.droppedSamples, "sample"), nounFor(count.droppedSamples, "was", "were"),
                     nounFor(count.droppedSamples, "it", "them"), count.firstDropped.x, count.firstDropped.y)});
  return result;
}

}  // namespace quintet::render
