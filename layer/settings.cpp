// SPDX-License-Identifier: Apache-2.0
#include "settings.h"

#include <cstdlib>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/parse.h"
#include "base/suggestion.h"
#include "base/text.h"

namespace quintet::layer {
namespace {

constexpr std::string_view kPrefix = "quintet_link_check.";
constexpr const char* kVariable = "QUINTET_LINK_CHECK";
constexpr const char* kFileName = "vk_layer_settings.txt";

std::string_view trimmed(std::string_view text) {
  constexpr const char* kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(kBlank) + 1 - first);
}

void set(Settings& settings, std::string_view source, std::string_view key, std::string_view value) {
  const auto flag = [&](bool& target) {
    if (value == "1" || value == "true")
      target = true;
    else if (value == "0" || value == "false")
      target = false;
    else
      settings.problems.push_back(fmt::format("{}: {} is '{}', but must be 0 or 1", source, key, printable(value)));
  };
  if (key == "sbt")
    flag(settings.sbt);
  else if (key == "wait")
    flag(settings.wait);
  else if (key == "output")
    settings.output = value;
  else if (key == "suppressions")
    settings.suppressions = value;
  else
    settings.problems.push_back(fmt::format("{}: unknown setting '{}'{}", source, printable(key),
                                            suggestionOrList(key, {"sbt", "wait", "output", "suppressions"})));
}

}  // namespace

void addVariable(Settings& settings, std::string_view text) {
  for (const std::string& part : splitText(text, ',')) {
    const std::string_view entry = trimmed(part);
    if (entry.empty()) continue;
    const std::size_t equals = entry.find('=');
    if (equals == entry.npos)
      settings.problems.push_back(
          fmt::format("{}: '{}' has no value; write sbt=1,output=link.sarif", kVariable, printable(entry)));
    else
      set(settings, kVariable, trimmed(entry.substr(0, equals)), trimmed(entry.substr(equals + 1)));
  }
}

void addFile(Settings& settings, std::string_view text) {
  for (const std::string& line : splitText(text, '\n')) {
    const std::string_view entry = trimmed(std::string_view(line).substr(0, line.find('#')));
    if (!entry.starts_with(kPrefix)) continue;
    const std::size_t equals = entry.find('=');
    const std::string_view value = equals == entry.npos ? std::string_view() : trimmed(entry.substr(equals + 1));
    set(settings, kFileName, trimmed(entry.substr(kPrefix.size(), equals - kPrefix.size())), value);
  }
}

Settings readSettings() {
  Settings settings;
  std::filesystem::path file = kFileName;
  if (const char* path = std::getenv("VK_LAYER_SETTINGS_PATH"); path && *path) {
    file = path;
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) file /= kFileName;
  }
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored)) {
    try {
      addFile(settings, readTextFile(file));
    } catch (const Error& error) {
      settings.problems.emplace_back(error.what());
    }
  }
  if (const char* variable = std::getenv(kVariable)) addVariable(settings, variable);
  return settings;
}

}  // namespace quintet::layer
