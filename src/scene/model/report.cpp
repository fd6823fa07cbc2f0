// SPDX-License-Identifier: Apache-2.0
#include "scene/model/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text.h"

namespace quintet::scene {
namespace {

std::string list(const char* label, const std::vector<std::string>& lines) {
  return lines.empty() ? std::string() : fmt::format("; {}: {}", label, fmt::join(lines, "; "));
}

}  // namespace

void FeatureTable::add(const std::string& kind, const std::string& name, const std::string& location, FeatureUse use,
                       const std::string& reason, std::size_t count) {
  const auto [known, isNew] = index_.try_emplace(std::tuple(kind, name, use, reason), features_.size());
  if (isNew) features_.push_back({kind, name, use, 0, location, reason});
  features_[known->second].count += count;
}

const char* nameOf(FeatureUse use) {
  switch (use) {
    case FeatureUse::used: return "used";
    case FeatureUse::unused: return "unused";
    case FeatureUse::repaired: return "repaired";
    case FeatureUse::ignored: return "ignored";
  }
  return "";
}

std::vector<std::string> unusedLines(const Report& report) {
  std::vector<std::string> lines;
  for (const Feature& feature : report.features) {
    if (feature.use != FeatureUse::unused || feature.reason.empty()) continue;
    const std::string times = feature.count > 1 ? fmt::format(" ({} times)", feature.count) : std::string();
    lines.push_back(fmt::format("{}: {}{}", feature.location, feature.reason, times));
  }
  return lines;
}

void requireExact(const std::filesystem::path& file, const Report& report) {
  if (report.isExact()) return;
  throw FileError(
      file, fmt::format("strict loading failed: {} ignored, {} repaired{}{}", report.ignored.size(),
                        report.repaired.size(), list("ignored", report.ignored), list("repaired", report.repaired)));
}

void makePrintable(Report& report) {
  for (auto* lines : {&report.extensionsUsed, &report.extensionsIgnored, &report.ignored, &report.repaired})
    for (std::string& line : *lines) line = printable(line);
  for (Feature& feature : report.features)
    for (std::string* text : {&feature.name, &feature.location, &feature.reason}) *text = printable(*text);
  for (MetadataEntry& entry : report.metadata)
    for (std::string* text : {&entry.object, &entry.name, &entry.value}) *text = printable(*text);
  for (KeyframeSummary& summary : report.keyframes) summary.object = printable(summary.object);
  report.generator = printable(report.generator);
  report.copyright = printable(report.copyright);
}

}  // namespace quintet::scene
