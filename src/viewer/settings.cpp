// SPDX-License-Identifier: Apache-2.0
#include "viewer/settings.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/json.h"

namespace quintet::viewer {
namespace {

using nlohmann::json;

constexpr std::uint32_t kMinWindowSide = 64;
constexpr std::uint32_t kMaxWindowSide = 16384;

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

// Sets `target` to the member, if it exists. A wrong type throws json::type_error.
template <class T>
void read(const json& object, const char* name, T& target) {
  const auto found = object.find(name);
  if (found != object.end()) target = found->get<T>();
}

}  // namespace

std::filesystem::path settingsFolder() {
  if (const std::string folder = environment("XDG_CONFIG_HOME"); !folder.empty())
    return std::filesystem::path(folder) / "quintet";
  if (const std::string home = environment("HOME"); !home.empty())
    return std::filesystem::path(home) / ".config" / "quintet";
  return {};
}

std::string settingsJson(const Settings& settings) {
  json object;
  object["theme"] = settings.theme == Theme::light ? "light" : "dark";
  object["bindings"] = settings.bindings;
  object["resolution"] = settings.resolution;
  object["scale"] = settings.scale;
  object["windowSize"] = {settings.windowSize.x, settings.windowSize.y};
  object["panels"] = settings.panels;
  object["panelWidth"] = settings.panelWidth;
  object["openPanels"] = settings.openPanels;
  object["recentFiles"] = settings.recentFiles;
  return object.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

Settings parseSettings(const std::string& text, const std::string& file) {
  Settings settings;
  try {
    const json object = parseJson(file, text);
    if (!object.is_object()) throw FileError(file, "the file is not a JSON object");
    std::string theme;
    read(object, "theme", theme);
    settings.theme = theme == "light" ? Theme::light : Theme::dark;
    read(object, "bindings", settings.bindings);
    read(object, "resolution", settings.resolution);
    read(object, "scale", settings.scale);
    std::vector<std::uint32_t> size;
    read(object, "windowSize", size);
    if (size.size() == 2) settings.windowSize = {size[0], size[1]};
    read(object, "panels", settings.panels);
    read(object, "panelWidth", settings.panelWidth);
    read(object, "openPanels", settings.openPanels);
    read(object, "recentFiles", settings.recentFiles);
  } catch (const json::exception& error) {
    throw FileError(file, fmt::format("the settings are invalid: {}", error.what()));
  }
  settings.resolution = settings.resolution > 0.0f ? std::clamp(settings.resolution, 0.125f, 1.0f) : 1.0f;
  if (!(settings.scale > 0.0f)) settings.scale = 0.0f;
  if (settings.scale > 0.0f) settings.scale = std::clamp(settings.scale, 0.5f, kMaxScale);
  settings.windowSize = glm::clamp(settings.windowSize, uvec2(kMinWindowSide), uvec2(kMaxWindowSide));
  settings.panelWidth =
      settings.panelWidth > 0.0f ? std::clamp(settings.panelWidth, kMinPanelWidth, kMaxPanelWidth) : 352.0f;
  if (settings.recentFiles.size() > kMaxRecentFiles) settings.recentFiles.resize(kMaxRecentFiles);
  return settings;
}

Settings readSettings(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return {};
  return parseSettings(readTextFile(file), file.string());
}

void writeSettings(const std::filesystem::path& file, const Settings& settings) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  if (error) throw FileError(file.parent_path(), fmt::format("cannot create the folder: {}", error.message()));
  writeFile(file, settingsJson(settings));
}

std::filesystem::path setAside(const std::filesystem::path& file) {
  const std::filesystem::path aside = file.string() + ".invalid";
  std::error_code error;
  std::filesystem::rename(file, aside, error);
  if (error) throw FileError(file, fmt::format("cannot rename the file to {}: {}", aside.string(), error.message()));
  return aside;
}

void addRecentFile(Settings& settings, const std::string& file) {
  std::error_code error;
  std::string name = file;
  if (std::filesystem::exists(file, error)) name = std::filesystem::absolute(file, error).lexically_normal().string();
  std::erase(settings.recentFiles, name);
  settings.recentFiles.insert(settings.recentFiles.begin(), name);
  if (settings.recentFiles.size() > kMaxRecentFiles) settings.recentFiles.resize(kMaxRecentFiles);
}

}  // namespace quintet::viewer
