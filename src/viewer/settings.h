// SPDX-License-Identifier: Apache-2.0
// Settings of the viewer that outlast the process, as a JSON file in the user's configuration folder.
#ifndef QUINTET_VIEWER_SETTINGS_H
#define QUINTET_VIEWER_SETTINGS_H

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "base/math.h"

namespace quintet::viewer {

enum class Theme { dark, light };

inline constexpr std::size_t kMaxRecentFiles = 12;
inline constexpr float kMaxScale = 4.0f;
inline constexpr float kMinPanelWidth = 200.0f, kMaxPanelWidth = 1000.0f;

struct Settings {
  Theme theme = Theme::dark;
  std::string bindings;         // name of a BindingSet; empty means the first
  float resolution = 1.0f;      // pixels of the image per pixel of the window, [0.125, 1]
  float scale = 0.0f;           // size of text and controls, [0.5, kMaxScale]; 0 means that of the display
  uvec2 windowSize{1280, 800};  // screen coordinates, which are pixels unless the window system scales the window
  bool panels = true;           // the panels beside the image are visible
  float panelWidth = 352.0f;    // pixels at scale 1, [kMinPanelWidth, kMaxPanelWidth]
  std::set<std::string> openPanels{"Scene", "Selection", "Display", "Parameters"};
  std::vector<std::string> recentFiles;  // absolute paths of scenes and programs, the latest first
  bool operator==(const Settings&) const = default;
};

// $XDG_CONFIG_HOME/quintet or ~/.config/quintet; empty if no home folder is known. The folder may not exist.
std::filesystem::path settingsFolder();

std::string settingsJson(const Settings& settings);
// Values out of range are clamped, and unknown members ignored, so that versions can share the file. `file` is the name
// in messages. Throws FileError if the text is not a JSON object, or if a member has the wrong type.
Settings parseSettings(const std::string& json, const std::string& file);

// The defaults if the file does not exist. Throws FileError.
Settings readSettings(const std::filesystem::path& file);
// Creates the folder if necessary. Throws FileError.
void writeSettings(const std::filesystem::path& file, const Settings& settings);

// Renames a file that cannot be read to FILE.invalid, so that writing does not replace it. Returns the new name. Throws
// FileError.
std::filesystem::path setAside(const std::filesystem::path& file);

// Makes the file the latest one. Names of built-in programs stay as they are; paths become absolute.
void addRecentFile(Settings& settings, const std::string& file);

}  // namespace quintet::viewer
#endif
