// SPDX-License-Identifier: Apache-2.0
#include "farm/plan.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/plural.h"
#include "job/version.h"
#include "render/film/film_file.h"
#include "shader/library.h"

namespace quintet::farm {
namespace {

using PlanJson = nlohmann::ordered_json;

constexpr const char* kFormat = "quintet farm plan";
constexpr int kFormatVersion = 1;
constexpr std::size_t kPartsPerFolder = 1000;

// Everything but the id.
PlanJson contentJson(const Plan& plan) {
  PlanJson parts = PlanJson::array();
  for (const Part& part : plan.parts) parts.push_back({part.first, part.last});
  return {{"version", plan.version},
          {"shaderLibrary", plan.libraryHash},
          {"scene", plan.scene.string()},
          {"sceneHash", plan.sceneHash},
          {"environmentHash", plan.environmentHash},
          {"programHash", plan.programHash},
          {"options", plan.options},
          {"workingFolder", plan.workingFolder.string()},
          {"image", plan.image.string()},
          {"samples", plan.samples},
          {"kind", partKindName(plan.kind)},
          {"parts", std::move(parts)}};
}

std::string idOf(const PlanJson& content) {
  return Hasher().add(content.dump(-1, ' ', false, PlanJson::error_handler_t::replace)).finish().hex();
}

// Throws JSON exceptions for wrong types.
Plan planOf(const PlanJson& json, const std::filesystem::path& file) {
  Plan plan;
  plan.version = json.at("version").get<std::string>();
  plan.libraryHash = json.at("shaderLibrary").get<std::string>();
  plan.scene = json.at("scene").get<std::string>();
  plan.sceneHash = json.at("sceneHash").get<std::string>();
  plan.environmentHash = json.at("environmentHash").get<std::string>();
  plan.programHash = json.at("programHash").get<std::string>();
  plan.options = json.at("options").get<std::vector<std::string>>();
  plan.workingFolder = json.at("workingFolder").get<std::string>();
  plan.image = json.at("image").get<std::string>();
  plan.samples = json.at("samples").get<std::uint64_t>();
  const auto kind = json.at("kind").get<std::string>();
  if (kind != "batches" && kind != "frames") throw FileError(file, "/kind", "is neither batches nor frames");
  plan.kind = kind == "frames" ? PartKind::frames : PartKind::batches;
  const PlanJson& parts = json.at("parts");
  if (!parts.is_array() || parts.empty() || parts.size() > kMaxParts) throw FileError(file, "/parts", "has no parts");
  plan.parts.reserve(parts.size());
  std::uint64_t next = 0;
  for (const PlanJson& part : parts) {
    const auto first = part.at(0).get<std::uint64_t>(), last = part.at(1).get<std::uint64_t>();
    if (first > last || last > 0xFFFFFFFFu || (first < next && !plan.parts.empty()))
      throw FileError(file, fmt::format("/parts/{}", plan.parts.size()), "is not a range after the one before it");
    plan.parts.push_back({first, last});
    next = last + 1;
  }
  return plan;
}

std::filesystem::path fileOfPart(const Plan& plan, std::size_t part, const char* extension) {
  return plan.folder / "parts" / fmt::format("{:03}", part / kPartsPerFolder) / fmt::format("{:06}{}", part, extension);
}

}  // namespace

const char* partKindName(PartKind kind) { return kind == PartKind::frames ? "frames" : "batches"; }

std::vector<Part> splitWork(std::uint64_t first, std::uint64_t last, std::uint64_t count, std::string_view noun,
                            std::string_view plural) {
  const std::uint64_t size = last - first + 1;
  if (count < 1) throw UsageError("the number of parts must be at least 1");
  if (count > kMaxParts) throw UsageError(fmt::format("{} parts: at most {} are possible", count, kMaxParts));
  if (count > size)
    throw UsageError(fmt::format("{} parts: the render has {}, so it has at most as many parts", count,
                                 counted(size, noun, plural)));
  std::vector<Part> parts;
  parts.reserve(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t begin = first + i * size / count, end = first + (i + 1) * size / count;
    parts.push_back({begin, end - 1});
  }
  return parts;
}

std::string planId(const Plan& plan) { return idOf(contentJson(plan)); }

std::string planText(const Plan& plan) {
  PlanJson content = contentJson(plan);
  PlanJson json{{"format", kFormat}, {"formatVersion", kFormatVersion}, {"id", idOf(content)}};
  const PlanJson parts = std::move(content["parts"]);
  content.erase("parts");
  json.update(content);
  // One part per line: a list of thousands stays readable.
  std::string text = json.dump(2, ' ', false, PlanJson::error_handler_t::replace);
  text.resize(text.rfind('\n'));
  text += ",\n  \"parts\": [";
  for (std::size_t i = 0; i < parts.size(); ++i) text += (i > 0 ? ",\n    " : "\n    ") + parts[i].dump();
  return text + "\n  ]\n}\n";
}

Plan readPlan(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::is_directory(path, ignored) ? path / kPlanFile : path;
  const std::string text = readTextFile(file);
  PlanJson json = findJson<PlanJson>(text).value_or(nullptr);
  if (!json.is_object() || json.value("format", PlanJson()) != kFormat)
    throw FileError(file, "is not a plan of 'quintet farm plan'");
  if (json.value("formatVersion", PlanJson()) != kFormatVersion)
    throw FileError(file, "/formatVersion", fmt::format("is not {}, which this Quintet reads", kFormatVersion));
  Plan plan;
  try {
    plan = planOf(json, file);
    if (json.at("id") != planId(plan)) throw FileError(file, "was changed after it was made: its id does not match");
  } catch (const PlanJson::exception& error) {
    throw FileError(file, std::string("an entry is missing or has the wrong type: ") + error.what());
  }
  plan.folder = std::filesystem::absolute(file).parent_path();
  return plan;
}

void requireSameVersion(const Plan& plan, const std::string& machine) {
  const std::string ours = job::quintetVersion();
  const std::string file = (plan.folder / kPlanFile).string();
  if (ours != plan.version)
    throw VersionError(fmt::format("{}: was made by Quintet {}, but {} has Quintet {}; install the same version", file,
                                   plan.version, machine, ours));
  if (shader::libraryHash().hex() != plan.libraryHash)
    throw VersionError(
        fmt::format("{}: was made by a Quintet {} with a different shader library than that of {}; "
                    "install the same build",
                    file, plan.version, machine));
}

void requireSameContent(const Plan& plan, const std::string& sceneHash, const std::string& environmentHash,
                        const std::string& programHash) {
  const auto require = [&](const std::string& expected, const std::string& found, const char* what) {
    if (expected != found)
      throw FileError(plan.scene, fmt::format("its {} changed since {} was made; make the plan again", what,
                                              (plan.folder / kPlanFile).string()));
  };
  require(plan.sceneHash, sceneHash, "content");
  require(plan.environmentHash, environmentHash, "environment");
  require(plan.programHash, programHash, "program");
}

std::string partName(const Plan& plan, std::size_t part) {
  const Part& p = plan.parts.at(part);
  if (p.first == p.last)
    return fmt::format("part {} ({} {})", part, plan.kind == PartKind::frames ? "frame" : "batch", p.first);
  return fmt::format("part {} ({} {}–{})", part, partKindName(plan.kind), p.first, p.last);
}

render::SampleRange samplesOf(const Plan& plan, std::size_t part) {
  const Part& p = plan.parts.at(part);
  const std::uint64_t end = std::min((p.last + 1) * render::kBatchSamples, plan.samples);
  return {static_cast<std::uint32_t>(p.first * render::kBatchSamples), static_cast<std::uint32_t>(end)};
}

std::filesystem::path partFile(const Plan& plan, std::size_t part) {
  return fileOfPart(plan, part, plan.kind == PartKind::frames ? ".frames.json" : render::kFilmExtension);
}
std::filesystem::path checkpointFile(const Plan& plan, std::size_t part) {
  return fileOfPart(plan, part, ".checkpoint.qfilm");
}
std::filesystem::path failureFile(const Plan& plan, std::size_t part) {
  return fileOfPart(plan, part, ".failure.json");
}

std::vector<std::filesystem::path> planFolders(const Plan& plan) {
  std::vector<std::filesystem::path> folders{plan.folder / "logs"};
  for (std::size_t part = 0; part < plan.parts.size(); part += kPartsPerFolder)
    folders.push_back(partFile(plan, part).parent_path());
  return folders;
}

}  // namespace quintet::farm
