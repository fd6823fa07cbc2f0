#include "film_facts.h"

#include <algorithm>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "session.h"
#include "shader/embedded_library.h"
#include "shader/include_resolver.h"
#include "values.h"

namespace quintet::app {
namespace {

using render::FilmFacts;

constexpr std::size_t kShownDigits = 12;  // of a hash
constexpr const char* kWantedError = "error wanted";

// Names of the files that decide what the program does: descriptions, shaders, and what those include, whatever its
// name ends in.
std::set<std::string> sourceNames(const program::Program& program) {
  std::set<std::string> names;
  std::vector<std::string> open;
  const auto add = [&](const std::string& name) {
    if (names.insert(name).second) open.push_back(name);
  };
  for (const auto& [name, text] : program.files)
    if (isProgramSource(name) && !name.ends_with(".scene.toml")) add(name);
  while (!open.empty()) {
    const std::string& text = program.files.at(open.back());
    open.pop_back();
    for (const shader::IncludeDirective& include : shader::findIncludes(text)) {
      const auto isMeant = [wanted = std::filesystem::path(include.name).filename()](const auto& file) {
        return std::filesystem::path(file.first).filename() == wanted;
      };
      const auto found = std::ranges::find_if(program.files, isMeant);
      if (found != program.files.end()) add(found->first);
    }
  }
  return names;
}

// Whatever the files' names: farms have the same files in other folders.
std::string hashOfFiles(const FilmSource& source) {
  Hasher hasher;
  for (const std::string& name : sourceNames(source.program)) hasher.add(name).add(source.program.files.at(name));
  for (const Hash& hash : source.shaderHashes) hasher.add(hash.high).add(hash.low);
  return hasher.finish().hex();
}

// A picture is its content; where it lies does not matter.
std::string imageText(const program::Program& program, const program::ImageValue& image) {
  if (image.file.empty()) return "none";
  Hasher hasher;
  if (image.ofProgram)
    hasher.add(program.files.at(image.file));
  else
    hasher.add(readTextFile(image.file));
  return hasher.finish().hex();
}

void addParameters(FilmFacts& facts, const FilmSource& source) {
  const nlohmann::ordered_json values = nlohmann::ordered_json::parse(source.parameters.toJson());
  const std::vector<program::ImageValue> images = source.parameters.images();
  for (const program::Parameter& parameter : source.parameters.parameters()) {
    const auto image = std::ranges::find(images, parameter.name, &program::ImageValue::parameter);
    facts.emplace_back("parameter " + parameter.name,
                       image != images.end() ? imageText(source.program, *image) : values.at(parameter.name).dump());
  }
}

std::string cameraText(const scene::Camera& camera) {
  return camera.orthographic
             ? fmt::format("orthographic {} x {}", camera.orthographicHalfSize.x, camera.orthographicHalfSize.y)
             : fmt::format("perspective, {} rad", camera.verticalFov);
}

std::string vectorText(const vec4& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

void addCamera(FilmFacts& facts, const scene::Camera& camera) {
  const mat4& m = camera.worldFromCamera;
  facts.emplace_back("camera", cameraText(camera));
  facts.emplace_back("camera position", vectorText(m[3]));
  facts.emplace_back("camera axes", fmt::format("{} {} {}", vectorText(m[0]), vectorText(m[1]), vectorText(m[2])));
  facts.emplace_back("camera lens", fmt::format("{} m, sharp at {} m", camera.apertureRadius, camera.focusDistance));
}

bool isHash(const std::string& text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == text.npos;
}

std::string shown(const std::string* value, const std::string& where) {
  if (!value) return "unknown " + where;
  return fmt::format("{} {}", isHash(*value) ? value->substr(0, kShownDigits) : *value, where);
}

}  // namespace

FilmFacts filmIdentity(const FilmSource& source, const RenderOptions& options) {
  std::vector<std::string> outputs;
  for (std::size_t i = 0; i < source.program.outputs.size(); ++i)
    if (source.film.stores(i)) outputs.push_back(source.program.outputs[i].name);
  const render::Region& region = source.film.region();
  FilmFacts facts{{"quintet", QUINTET_VERSION},
                  {"scene", source.sceneHash},
                  {"environment", source.environmentHash},
                  {"program", source.program.name},
                  {"program files", hashOfFiles(source)},
                  {"shader library", shader::libraryHash().hex()}};
  addParameters(facts, source);
  addCamera(facts, source.camera);
  facts.emplace_back("size", fmt::format("{}x{}", source.size.x, source.size.y));
  facts.emplace_back("region", fmt::format("{},{},{},{}", region.x, region.y, region.width, region.height));
  facts.emplace_back("seed", fmt::format("{}", options.seed));
  // A sampler may place its points for the number that there will be.
  facts.emplace_back("samples planned", options.samples ? fmt::format("{}", *options.samples) : "any number");
  facts.emplace_back("adaptive", options.adaptive ? "yes" : "no");
  facts.emplace_back("transparent", options.transparent ? "yes" : "no");
  facts.emplace_back("outputs", fmt::format("{}", fmt::join(outputs, ", ")));
  return facts;
}

FilmFacts filmNotes(const program::Program& program, const RenderOptions& options, const RenderRecord& record) {
  FilmFacts facts{{"command", record.commandLine},
                  {"scene", record.scene},
                  {"environment", record.environment},
                  {"camera", record.camera},
                  {"parameters", record.parameters},
                  {"device", record.device},
                  {"driver", record.driver},
                  {"seconds", fmt::format("{:.6f}", record.renderSeconds)},
                  {kWantedError, options.error ? fmt::format("{}", *options.error) : ""},
                  {kExposureFact, exposureText(options.exposure)},
                  {kToneMapFact, toneMapText(options.toneMap)},
                  {kAllOutputsFact, options.allOutputs ? "yes" : "no"}};
  for (const program::Output& output : program.outputs) {
    facts.emplace_back("kind of " + output.name, std::string(program::outputKindName(output.kind)));
    facts.emplace_back("colour in " + output.name, program::holdsColor(output) ? "yes" : "no");
  }
  return facts;
}

std::string exposureText(float stops) { return fmt::format("{}", stops); }

std::string toneMapText(const std::optional<render::ToneMap>& toneMap) {
  return toneMap ? render::toneMapNames()[static_cast<std::size_t>(*toneMap)] : "";
}

std::string factText(const FilmFacts& facts, const std::string& name) {
  const std::string* found = render::findFact(facts, name);
  return found ? *found : std::string();
}

void setFact(FilmFacts& facts, const std::string& name, const std::string& value) {
  const auto found = std::ranges::find(facts, name, &FilmFacts::value_type::first);
  if (found == facts.end())
    facts.emplace_back(name, value);
  else
    found->second = value;
}

void fillRecord(RenderRecord& record, const render::FilmFile& file) {
  const auto note = [&](const char* name) { return factText(file.notes, name); };
  const auto fact = [&](const char* name) { return factText(file.identity, name); };
  const render::Region& region = file.film.region;
  const uvec2 size = parseSize("size", fact("size"));
  if (std::uint64_t{region.x} + region.width > size.x || std::uint64_t{region.y} + region.height > size.y)
    throw UsageError("the region is not in the picture");
  record.scene = note("scene");
  record.sceneHash = fact("scene");
  record.environment = note("environment");
  record.camera = note("camera");
  record.program = fact("program");
  record.parameters = note("parameters");
  record.device = note("device");
  record.driver = note("driver");
  record.transparent = fact("transparent") == "yes";
  record.width = size.x;
  record.height = size.y;
  record.region = {region.x, region.y, region.width, region.height};
  record.seed = static_cast<std::uint32_t>(parseNumber("seed", fact("seed"), 0, 4294967295.0));
  record.samples = static_cast<std::uint64_t>(render::averageSamples(region, file.film.counts));
  record.adaptive = isAdaptive(file);
  record.wantedError = wantedErrorOf(file);
  record.renderSeconds = parseNumber("seconds", note("seconds"), 0, 1e12);
  for (const uvec2& pixel : file.film.statistics) {
    record.rays += pixel.x;
    record.droppedSamples += pixel.y;
  }
}

std::optional<std::uint64_t> plannedSamples(const render::FilmFile& file) {
  const std::string* text = render::findFact(file.identity, "samples planned");
  if (!text || text->empty() || text->size() > 9 || text->find_first_not_of("0123456789") != text->npos)
    return std::nullopt;
  return std::stoull(*text);
}

std::optional<double> wantedErrorOf(const render::FilmFile& file) {
  const std::string text = factText(file.notes, kWantedError);
  return text.empty() ? std::nullopt : std::optional(parseNumber(kWantedError, text, 0.0, 1e12));
}

bool isAdaptive(const render::FilmFile& file) { return factText(file.identity, "adaptive") == "yes"; }

std::vector<std::string> differenceLines(const std::vector<render::FactDifference>& differences,
                                         const std::string& left, const std::string& right) {
  std::vector<std::string> lines;
  for (const render::FactDifference& d : differences)
    lines.push_back(fmt::format("{}: {}, {}", d.name, shown(d.left, left), shown(d.right, right)));
  return lines;
}

std::string rangesText(const std::vector<render::SampleRange>& ranges) {
  std::vector<std::string> texts;
  for (const render::SampleRange& range : ranges) texts.push_back(fmt::format("{} to {}", range.begin, range.end - 1));
  return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, " and "));
}

std::string samplesText(const render::FilmFile& file) {
  const std::vector<std::uint32_t>& batches = file.film.counts.cellBatches;
  if (batches.empty()) return "samples " + rangesText(file.film.counts.ranges);
  std::uint32_t fewest = std::numeric_limits<std::uint32_t>::max(), most = 0;
  const std::vector<std::uint32_t> pixels = render::cellPixels(file.film.region);
  for (std::size_t c = 0; c < batches.size(); ++c) {
    if (pixels[c] == 0) continue;
    fewest = std::min(fewest, batches[c]);
    most = std::max(most, batches[c]);
  }
  return fmt::format("{:.1f} samples per pixel on average ({} to {})",
                     render::averageSamples(file.film.region, file.film.counts), fewest * render::kBatchSamples,
                     most * render::kBatchSamples);
}

}  // namespace quintet::app
