// SPDX-License-Identifier: Apache-2.0
#include "viewer/settings.h"

#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "temp_folder.h"

namespace quintet::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

// Sets an environment variable during a test.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    const char* old = std::getenv(name);
    if (old) old_ = old;
    existed_ = old != nullptr;
    if (value)
      ::setenv(name, value, 1);
    else
      ::unsetenv(name);
  }
  ~Variable() {
    if (existed_)
      ::setenv(name_, old_.c_str(), 1);
    else
      ::unsetenv(name_);
  }

 private:
  const char* name_;
  std::string old_;
  bool existed_ = false;
};

Settings someSettings() {
  Settings settings;
  settings.theme = Theme::light;
  settings.bindings = "Blender";
  settings.resolution = 0.5f;
  settings.scale = 1.5f;
  settings.windowSize = {1920, 1080};
  settings.panels = false;
  settings.panelWidth = 400;
  settings.openPanels = {"Camera"};
  settings.recentFiles = {"/a.glb", "/b \"c\".glb"};
  return settings;
}

TEST(ViewerSettings, SurviveTheFile) {
  EXPECT_EQ(parseSettings(settingsJson(someSettings()), "viewer.json"), someSettings());
  EXPECT_EQ(parseSettings(settingsJson({}), "viewer.json"), Settings{});
}

TEST(ViewerSettings, AreInTheConfigurationFolder) {
  const Variable home("HOME", "/home/someone");
  {
    const Variable config("XDG_CONFIG_HOME", "/config");
    EXPECT_EQ(settingsFolder(), "/config/quintet");
  }
  {
    const Variable config("XDG_CONFIG_HOME", nullptr);
    EXPECT_EQ(settingsFolder(), "/home/someone/.config/quintet");
    const Variable noHome("HOME", nullptr);
    EXPECT_EQ(settingsFolder(), "");
  }
}

TEST(ViewerSettings, CreateTheirFolder) {
  const test::TempFolder folder;
  const std::filesystem::path file = folder / "config/quintet/viewer.json";
  EXPECT_EQ(readSettings(file), Settings{});
  writeSettings(file, someSettings());
  EXPECT_EQ(readSettings(file), someSettings());
}

TEST(ViewerSettings, ClampValuesOutOfRange) {
  const Settings settings = parseSettings(
      R"({"scale": 100, "resolution": -1, "panelWidth": 5, "windowSize": [1, 1000000], "unknown": 1, "theme": "blue"})",
      "viewer.json");
  EXPECT_EQ(settings.scale, kMaxScale);
  EXPECT_EQ(settings.resolution, 1.0f);
  EXPECT_EQ(settings.panelWidth, 200.0f);
  EXPECT_EQ(settings.windowSize, uvec2(64, 16384));
  EXPECT_EQ(settings.theme, Theme::dark);
}

TEST(ViewerSettings, RejectOtherFiles) {
  EXPECT_THAT([] { parseSettings("[1]", "viewer.json"); }, ThrowsMessage<FileError>(HasSubstr("viewer.json")));
  EXPECT_THAT([] { parseSettings("{", "viewer.json"); }, ThrowsMessage<FileError>(HasSubstr("viewer.json")));
  EXPECT_THAT([] { parseSettings(R"({"scale": "big"})", "viewer.json"); },
              ThrowsMessage<FileError>(HasSubstr("viewer.json")));
}

TEST(ViewerSettings, KeepRecentFilesOnce) {
  const test::TempFolder folder;
  writeFile(folder / "a.glb", "");
  Settings settings;
  addRecentFile(settings, (folder / "a.glb").string());
  addRecentFile(settings, "lessons/05_shadow");
  addRecentFile(settings, (folder / "x/../a.glb").string());
  EXPECT_THAT(settings.recentFiles,
              ElementsAre((folder / "x/../a.glb").string(), "lessons/05_shadow", (folder / "a.glb").string()))
      << "a path whose folder does not exist stays as it is";
  settings.recentFiles.clear();
  std::filesystem::create_directory(folder / "x");
  addRecentFile(settings, (folder / "a.glb").string());
  addRecentFile(settings, (folder / "x/../a.glb").string());
  EXPECT_THAT(settings.recentFiles, ElementsAre((folder / "a.glb").string()));
  for (std::size_t i = 0; i < 2 * kMaxRecentFiles; ++i) addRecentFile(settings, std::to_string(i));
  EXPECT_EQ(settings.recentFiles.size(), kMaxRecentFiles);
  EXPECT_EQ(settings.recentFiles.front(), std::to_string(2 * kMaxRecentFiles - 1));
}

TEST(Settings, AnInvalidFileIsSetAside) {
  const test::TempFolder folder;
  const std::filesystem::path file = folder / "viewer.json";
  writeFile(file, "{");
  EXPECT_THROW(readSettings(file), FileError);
  EXPECT_EQ(setAside(file), folder / "viewer.json.invalid");
  EXPECT_EQ(readTextFile(folder / "viewer.json.invalid"), "{");
  EXPECT_EQ(readSettings(file), Settings{});
  EXPECT_THROW(setAside(folder / "missing.json"), FileError);
}

}  // namespace
}  // namespace quintet::viewer
