// SPDX-License-Identifier: Apache-2.0
#include "farm/part_check.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/parallel.h"
#include "base/plural.h"
#include "farm/part_failure.h"
#include "job/film_store.h"
#include "render/film/film_reader.h"

namespace quintet::farm {
namespace {

using FrameJson = nlohmann::ordered_json;

constexpr std::size_t kShownProblems = 8;
constexpr std::size_t kShownIdDigits = 12;

PartCheck missingPart(const Plan& plan, std::size_t part) {
  const std::optional<PartFailure> failure = readFailure(plan, part);
  if (!failure) return {PartState::missing, ""};
  if (failure->status == 0)
    return {PartState::missing, fmt::format("started on {} and not finished", failure->machine)};
  return {PartState::missing,
          fmt::format("failed on {} with status {}: {}", failure->machine, failure->status, failure->message)};
}

PartCheck problem(PartState state, const std::filesystem::path& file, const std::string& text) {
  return {state, file.string() + ": " + text};
}

PartCheck foreignPlan(const std::filesystem::path& file, const std::string& found, const std::string& expected) {
  return problem(PartState::foreign, file,
                 found.empty() ? "belongs to no plan"
                               : fmt::format("belongs to the plan {}, expected {}", found.substr(0, kShownIdDigits),
                                             expected.substr(0, kShownIdDigits)));
}

PartCheck wrongVersion(const Plan& plan, const std::filesystem::path& file, const std::string& version) {
  return problem(PartState::wrongVersion, file,
                 version == plan.version
                     ? fmt::format("was rendered by a Quintet {} with a different shader library", version)
                     : fmt::format("was rendered by Quintet {}, expected {}", version, plan.version));
}

// The part of the plan that has exactly these samples.
std::optional<std::size_t> partWithSamples(const Plan& plan, const std::vector<render::SampleRange>& ranges) {
  if (ranges.size() != 1) return std::nullopt;
  const std::uint64_t batch = ranges[0].begin / render::kBatchSamples;
  const auto found = std::ranges::lower_bound(plan.parts, batch, {}, &Part::first);
  if (found == plan.parts.end()) return std::nullopt;
  const auto part = static_cast<std::size_t>(found - plan.parts.begin());
  return samplesOf(plan, part) == ranges[0] ? std::optional(part) : std::nullopt;
}

PartCheck checkFilm(const Plan& plan, const std::string& id, std::size_t part, CheckDepth depth) {
  const std::filesystem::path file = partFile(plan, part);
  try {
    render::FilmReader reader(file);
    const render::FilmFile& film = reader.header();
    const job::Provenance p = job::provenanceOf(film, file);
    if (p.version != plan.version || p.libraryHash != plan.libraryHash) return wrongVersion(plan, file, p.version);
    if (p.farmPlan != id) return foreignPlan(file, p.farmPlan, id);
    const std::vector<render::SampleRange>& ranges = film.film.counts.ranges;
    const render::SampleRange expected = samplesOf(plan, part);
    if (ranges != std::vector{expected}) {
      const bool within = std::ranges::all_of(ranges, [&](const render::SampleRange& range) {
        return expected.begin <= range.begin && range.end <= expected.end;
      });
      std::string text = fmt::format("holds {}, expected {}", job::rangesText(ranges), job::rangesText({expected}));
      if (within) return problem(PartState::incomplete, file, text);
      if (const auto other = partWithSamples(plan, ranges)) text += fmt::format("; it is a copy of part {}", *other);
      return problem(PartState::foreign, file, text);
    }
    if (depth == CheckDepth::content) reader.verify();
  } catch (const FileError& error) {
    return {PartState::damaged, error.what()};
  }
  return {PartState::done, ""};
}

// Checks an image of the list.
PartCheck checkImage(const std::filesystem::path& image, const FrameJson& entry, CheckDepth depth) {
  std::error_code failed;
  const std::uintmax_t bytes = std::filesystem::file_size(image, failed);
  if (failed) return problem(PartState::incomplete, image, "is missing");
  const auto expected = entry.at("bytes").get<std::uint64_t>();
  if (bytes != expected)
    return problem(PartState::damaged, image, fmt::format("has {}, expected {}", counted(bytes, "byte"), expected));
  if (depth == CheckDepth::content &&
      Hasher().add(readFile(image)).finish().hex() != entry.at("hash").get<std::string>())
    return problem(PartState::damaged, image, "its content changed since it was written");
  return {PartState::done, ""};
}

PartCheck checkFrames(const Plan& plan, const std::string& id, std::size_t part, CheckDepth depth) {
  const std::filesystem::path file = partFile(plan, part);
  try {
    const FrameJson json = parseJson<FrameJson>(file, readTextFile(file));
    if (json.at("version") != plan.version || json.at("shaderLibrary") != plan.libraryHash)
      return wrongVersion(plan, file, json.at("version").get<std::string>());
    if (json.at("plan") != id) return foreignPlan(file, json.at("plan").get<std::string>(), id);
    if (json.at("part") != part)
      return problem(PartState::foreign, file, fmt::format("it is a copy of part {}", json.at("part").dump()));
    std::set<std::uint64_t> frames;
    for (const FrameJson& entry : json.at("files")) {
      const std::filesystem::path image = plan.folder / entry.at("file").get<std::string>();
      if (PartCheck check = checkImage(image, entry, depth); check.state != PartState::done) return check;
      frames.insert(entry.at("frame").get<std::uint64_t>());
    }
    for (std::uint64_t frame = plan.parts[part].first; frame <= plan.parts[part].last; ++frame)
      if (!frames.contains(frame))
        return problem(PartState::incomplete, file, fmt::format("frame {} is missing", frame));
  } catch (const FrameJson::exception& error) {
    return problem(PartState::damaged, file, error.what());
  } catch (const FileError& error) {
    return {PartState::damaged, error.what()};
  }
  return {PartState::done, ""};
}

PartCheck checkPartOf(const Plan& plan, const std::string& id, std::size_t part, CheckDepth depth) {
  std::error_code ignored;
  if (!std::filesystem::exists(partFile(plan, part), ignored)) return missingPart(plan, part);
  return plan.kind == PartKind::frames ? checkFrames(plan, id, part, depth) : checkFilm(plan, id, part, depth);
}

bool isResult(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  if (name.starts_with('.') || name.ends_with(".checkpoint.qfilm")) return false;
  return name.ends_with(render::kFilmExtension) || name.ends_with(".frames.json");
}

}  // namespace

std::string_view partStateName(PartState state) {
  constexpr std::array<std::string_view, kPartStates> kNames{"done",    "missing", "incomplete",
                                                             "damaged", "foreign", "wrong version"};
  return kNames[static_cast<std::size_t>(state)];
}

PartCheck checkPart(const Plan& plan, std::size_t part, CheckDepth depth) {
  return checkPartOf(plan, planId(plan), part, depth);
}

std::vector<PartCheck> checkParts(const Plan& plan, CheckDepth depth) {
  const std::string id = planId(plan);
  std::vector<PartCheck> checks(plan.parts.size());
  parallelFor(checks.size(), [&](std::size_t part) { checks[part] = checkPartOf(plan, id, part, depth); });
  return checks;
}

std::vector<std::filesystem::path> unexpectedFiles(const Plan& plan) {
  std::set<std::filesystem::path> expected;
  for (std::size_t part = 0; part < plan.parts.size(); ++part) expected.insert(partFile(plan, part));
  std::vector<std::filesystem::path> found;
  std::error_code failed;
  using Files = std::filesystem::recursive_directory_iterator;
  for (auto file = Files(plan.folder / "parts", failed); !failed && file != Files(); file.increment(failed))
    if (isResult(file->path()) && !expected.contains(file->path())) found.push_back(file->path());
  std::ranges::sort(found);
  return found;
}

void requireUsable(const Plan& plan, const std::vector<PartCheck>& checks,
                   const std::vector<std::filesystem::path>& unexpected, bool allowMissing) {
  std::vector<std::string> problems;
  std::size_t usable = 0;
  for (std::size_t part = 0; part < checks.size(); ++part) {
    const auto& [state, text] = checks[part];
    usable += state == PartState::done;
    if (state == PartState::done || (allowMissing && (state == PartState::missing || state == PartState::incomplete)))
      continue;
    problems.push_back(fmt::format(
        "{} {}{}{}", partName(plan, part),
        state == PartState::wrongVersion ? "has the wrong version" : fmt::format("is {}", partStateName(state)),
        text.empty() ? "" : ": ", text));
  }
  for (const std::filesystem::path& file : unexpected)
    problems.push_back(fmt::format("{}: is not a part of this plan; remove it", file.string()));
  if (problems.empty()) return;
  std::string text =
      fmt::format("{}: {} of {} usable", (plan.folder / kPlanFile).string(), usable, counted(checks.size(), "part"));
  for (std::size_t i = 0; i < std::min(problems.size(), kShownProblems); ++i) text += "; " + problems[i];
  if (problems.size() > kShownProblems) text += fmt::format("; and {} more", problems.size() - kShownProblems);
  throw Error(text + "; run submit.sh or parallel.sh of the plan again to render what is missing or damaged");
}

void writeFrameList(const Plan& plan, std::size_t part, const std::vector<WrittenFrame>& frames) {
  FrameJson files = FrameJson::array();
  for (const WrittenFrame& frame : frames)
    for (const std::filesystem::path& image : frame.files) {
      const std::vector<std::byte> bytes = readFile(image);
      files.push_back({{"file", image.lexically_relative(plan.folder).string()},
                       {"frame", frame.frame},
                       {"bytes", bytes.size()},
                       {"hash", Hasher().add(bytes).finish().hex()}});
    }
  const FrameJson json{{"plan", planId(plan)},
                       {"version", plan.version},
                       {"shaderLibrary", plan.libraryHash},
                       {"part", part},
                       {"files", std::move(files)}};
  writeFile(partFile(plan, part), json.dump(1, ' ', false, FrameJson::error_handler_t::replace) + "\n");
}

}  // namespace quintet::farm
