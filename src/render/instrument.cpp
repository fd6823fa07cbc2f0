#include "render/instrument.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace quintet::render {
namespace {

std::string vectorText(const vec3& v) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z); }

// `line` of the stage's file if a trace stands there, with its last line at the latest; else the trace is in an included
// file, whose lines are not the stage's, and no line is said.
int traceLine(const program::Program& program, const std::string& file, std::uint32_t line) {
  const auto found = program.files.find(file);
  if (found == program.files.end() || line == 0) return 0;
  const std::string& text = found->second;
  std::size_t begin = 0;
  for (std::uint32_t k = 1; k < line; ++k) {
    begin = text.find('\n', begin);
    if (begin == std::string::npos) return 0;
    ++begin;
  }
  const std::size_t trace = text.rfind("traceRayEXT", text.find('\n', begin));
  if (trace == std::string::npos) return 0;
  const bool endsBefore = trace < begin && text.find(';', trace) < begin;
  return endsBefore ? 0 : static_cast<int>(line);
}

std::string describe(const shared::InstrumentReport& report, std::size_t missCount) {
  const std::string where = fmt::format("pixel {}, {}, depth {}", report.pixel.x, report.pixel.y, report.depth);
  switch (report.kind) {
    case shared::kReportRay:
      return fmt::format("the ray is not valid: origin {}, direction {} ({})", vectorText(report.origin),
                         vectorText(report.direction), where);
    case shared::kReportMiss:
      return fmt::format("miss index {} is beyond the table, which has {}; the trace was not executed ({})",
                         report.index, missCount, where);
    case shared::kReportDepth:
      return fmt::format("this trace is deeper than the pipeline was made for; it was not executed ({})", where);
    default:
      return fmt::format(
          "the ray meets the primitive that it has just left, {:.3g} away: less than the rounding error of its origin "
          "{} ({})",
          report.distance, vectorText(report.origin), where);
  }
}

void addRecords(const shared::Instrument& notes, const program::Program& program, const program::SceneFacts& facts,
                std::vector<shader::Diagnostic>& result) {
  const auto rays = static_cast<std::uint32_t>(program.rays.size());
  const std::uint64_t records = std::uint64_t{facts.geometries.size()} * rays;
  const std::string file = program.path(sourceFile(program, program.rayGeneration));
  for (std::uint32_t pair = 0; pair < 256; ++pair) {
    if ((notes.recordPairs[pair / 32] >> (pair % 32) & 1u) == 0) continue;
    const std::uint32_t offset = pair % 16, stride = pair / 16;
    for (const program::InstanceFacts& instance : facts.instances) {
      if (instance.geometryCount == 0) continue;
      const std::uint64_t record =
          std::uint64_t{instance.firstGeometry} * rays + std::uint64_t{instance.geometryCount - 1} * stride + offset;
      if (record < records) continue;
      result.push_back(
          {shader::Severity::error, file, 0, 0, "Q004",
           fmt::format("a trace with offset {} and stride {} reaches hit record {} at instance '{}'; the table has {}",
                       offset, stride, record, instance.name, records)});
      break;
    }
  }
}

}  // namespace

std::string sourceFile(const program::Program& program, const std::string& stage) {
  return stage.starts_with(program.descriptionFile + ".") ? program.descriptionFile : stage;
}

InstrumentBuffer::InstrumentBuffer(gpu::Context& context, std::uint64_t pixels, std::uint32_t depthLimit,
                                   std::size_t missCount) {
  std::vector<std::byte> bytes(sizeof(InstrumentNotes) + pixels * sizeof(shared::InstrumentPixel));
  auto& header = *reinterpret_cast<shared::Instrument*>(bytes.data());
  header.pixelCount = static_cast<std::uint32_t>(pixels);
  header.depthLimit = depthLimit;
  header.missCount = static_cast<std::uint32_t>(missCount);
  buffer_ = gpu::makeBuffer(context, bytes, 0, "instrument");
}

InstrumentNotes InstrumentBuffer::download() const {
  InstrumentNotes notes;
  buffer_.download(std::as_writable_bytes(std::span(&notes, 1)));
  return notes;
}

std::vector<shader::Diagnostic> instrumentDiagnostics(const InstrumentNotes& written, const program::Program& program,
                                                      const program::CompiledProgram& compiled,
                                                      const program::SceneFacts& facts) {
  std::vector<shader::Diagnostic> result;
  const shared::Instrument& notes = written.counts;
  struct Place {
    std::uint32_t count = 0;
    shared::InstrumentReport first;
  };
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, Place> places;
  for (std::uint32_t i = 0; i < std::min(notes.reportCount, shared::kInstrumentReports); ++i) {
    const shared::InstrumentReport& report = written.reports[i];
    Place& place = places[{report.kind, report.stage, report.line}];
    if (place.count++ == 0) place.first = report;
  }
  for (const auto& [key, place] : places) {
    const std::string file =
        sourceFile(program, place.first.stage < compiled.stages.size() ? compiled.stages[place.first.stage].file
                                                                       : program.rayGeneration);
    const bool selfHit = place.first.kind == shared::kReportSelfHit;
    std::string text = describe(place.first, notes.missCount);
    if (place.count > 1)
      text += fmt::format("; {} such{}", place.count, notes.reportCount > shared::kInstrumentReports ? " or more" : "");
    result.push_back({selfHit ? shader::Severity::warning : shader::Severity::error, program.path(file),
                      traceLine(program, file, place.first.line), 0, fmt::format("Q00{}", place.first.kind), text});
  }
  addRecords(notes, program, facts, result);
  if (notes.anyHitCount > 0)
    result.push_back(
        {shader::Severity::note, program.path(sourceFile(program, program.rayGeneration)), 0, 0, "Q006",
         fmt::format("{} calls of any-hit shaders for {} traces; {:.2f} per pixel, {} in the one with most",
                     notes.anyHitCount, notes.traceCount,
                     static_cast<double>(notes.anyHitCount) / std::max(1u, notes.pixelCount), notes.mostAnyHits)});
  return result;
}

}  // namespace quintet::render
