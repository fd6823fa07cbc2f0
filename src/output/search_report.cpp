// SPDX-License-Identifier: Apache-2.0
#include "output/search_report.h"

#include <utility>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/plural.h"
#include "base/text.h"
#include "base/wrap.h"
#include "job/float_json.h"
#include "output/float_text.h"
#include "output/json_line.h"

namespace quintet::output {
namespace {

using Json = nlohmann::ordered_json;

std::string causeText(const job::SampleCause& cause) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (cause.bounce >= 0) add(counted(cause.bounce, "bounce"));
  const auto materialText = [](const std::string& name) { return "material \"" + printable(name) + "\""; };
  if (!cause.lobe.empty()) {
    const std::string& material = cause.lobeMaterial;
    add(cause.lobe + " lobe" + (material.empty() ? "" : " of " + materialText(material)));
  }
  if (!cause.material.empty() && (cause.lobe.empty() || cause.lobeIsBefore || cause.lobeMaterial.empty()))
    add((cause.lobeIsBefore ? "then " : "") + materialText(cause.material));
  if (!cause.instance.empty()) add("instance \"" + printable(cause.instance) + "\"");
  if (cause.origin)
    add(fmt::format("{}: {}", printable(locationText(cause.origin->location.file, cause.origin->location.line, 0)),
                    job::originText(*cause.origin)));
  else if (!cause.field.empty())
    add(fmt::format("{} of {} is not finite", printable(cause.field), cause.event));
  return text;
}

// " (4 adjacent pixels from 0,4 to 3,4; 16 samples)"; empty for a group of one sample.
std::string groupText(const job::FoundSample& found, bool frames) {
  if (found.groupSamples <= 1) return {};
  const std::string samples =
      frames || found.groupSamples == found.groupPixels ? "" : counted(found.groupSamples, "sample");
  if (found.groupPixels == 1) return samples.empty() ? "" : fmt::format(" ({} of this pixel)", samples);
  return fmt::format(" ({} adjacent pixels from {},{} to {},{}{}{})", found.groupPixels, found.least.x, found.least.y,
                     found.most.x, found.most.y, samples.empty() ? "" : "; ", samples);
}

std::string sampleText(const job::FoundSample& found, bool frames, const std::string& value,
                       const CommandFor& commandFor, std::size_t width) {
  std::string text = fmt::format("  pixel {},{}, {} {}: {}\n", found.pixel.x, found.pixel.y,
                                 frames ? "frame" : "sample", found.sample, value + groupText(found, frames));
  const std::string cause = causeText(found.cause);
  if (!cause.empty()) text += "    " + wrapped(cause, width, 4, 4) + "\n";
  return text + "    " + commandFor(found) + "\n";  // one line, so that it can be copied
}

std::string brightnessText(const job::FoundSample& firefly) {
  if (firefly.level == 0.0f) return fmt::format("luminance {:.4g} in black surroundings", firefly.luminance);
  return fmt::format("luminance {:.4g}, {:.4g} times that of its surroundings", firefly.luminance,
                     firefly.luminance / firefly.level);
}

// "23 fireflies in 12 groups of adjacent pixels, of which 10 are listed" if some were only counted.
std::string countText(std::uint64_t all, std::uint64_t groups, std::size_t listed, std::string_view noun,
                      std::string_view plural) {
  std::string text = counted(all, noun, plural);
  if (groups < all) text += " in " + counted(groups, "group of adjacent pixels", "groups of adjacent pixels");
  if (listed < groups) text += fmt::format(", of which {} {} listed", listed, nounFor(listed, "is", "are"));
  return text;
}

Json sampleJson(const job::FoundSample& found, const CommandFor& commandFor) {
  Json json{{"pixel", {found.pixel.x, found.pixel.y}},
            {"sample", found.sample},
            {"value", job::floatsJson({&found.value[0], 3})},
            {"group",
             {{"pixels", found.groupPixels},
              {"samples", found.groupSamples},
              {"from", {found.least.x, found.least.y}},
              {"to", {found.most.x, found.most.y}}}}};
  const job::SampleCause& cause = found.cause;
  json["bounce"] = cause.bounce >= 0 ? Json(cause.bounce) : Json();
  for (const auto& [name, text] : {std::pair{"lobe", cause.lobe},
                                   {"lobeMaterial", cause.lobeMaterial},
                                   {"material", cause.material},
                                   {"instance", cause.instance},
                                   {"event", cause.event},
                                   {"field", cause.field}})
    json[name] = text.empty() ? Json() : Json(text);
  json["file"] = cause.origin ? Json(cause.origin->location.file) : Json();
  json["line"] = cause.origin ? Json(cause.origin->location.line) : Json();
  json["operation"] = cause.origin ? Json(cause.origin->operation) : Json();
  json["command"] = commandFor(found);
  return json;
}

}  // namespace

std::string searchText(const job::SearchResult& result, const CommandFor& commandFor, std::size_t width) {
  std::string text;
  if (result.notFiniteCount > 0) {
    const auto& [noun, plural] = result.frames ? std::pair("pixel that is not finite", "pixels that are not finite")
                                               : std::pair("sample that is not finite", "samples that are not finite");
    text += countText(result.notFiniteCount, result.notFiniteGroups, result.notFinite.size(), noun, plural) + "\n";
    for (const job::FoundSample& found : result.notFinite)
      text += sampleText(found, result.frames, vectorText(found.value), commandFor, width);
  }
  if (result.fireflyCount > 0) {
    text += fmt::format(
        "{}{}\n", text.empty() ? "" : "\n",
        countText(result.fireflyCount, result.fireflyGroups, result.fireflies.size(), "firefly", "fireflies"));
    for (const job::FoundSample& found : result.fireflies)
      text += sampleText(found, result.frames, brightnessText(found), commandFor, width);
  }
  if (text.empty())
    text = fmt::format("nothing found in {}\n", result.frames ? counted(result.samples, "frame")
                                                              : counted(result.samples, "sample") + " per pixel");
  return text;
}

std::string searchJson(const job::SearchResult& result, const CommandFor& commandFor) {
  Json json{{"samples", result.samples},
            {"frames", result.frames},
            {"interrupted", result.interrupted},
            {"notFiniteCount", result.notFiniteCount},
            {"fireflyCount", result.fireflyCount},
            {"notFiniteGroups", result.notFiniteGroups},
            {"fireflyGroups", result.fireflyGroups},
            {"notFinite", Json::array()},
            {"fireflies", Json::array()}};
  for (const job::FoundSample& found : result.notFinite) json["notFinite"].push_back(sampleJson(found, commandFor));
  for (const job::FoundSample& found : result.fireflies) {
    Json entry = sampleJson(found, commandFor);
    entry["luminance"] = job::floatJson(found.luminance);
    entry["level"] = job::floatJson(found.level);
    json["fireflies"].push_back(std::move(entry));
  }
  return jsonLine(json);
}

}  // namespace quintet::output
