// SPDX-License-Identifier: Apache-2.0
// The real window on an X server without a screen, with synthetic input. Each test fails for validation messages, and
// if the viewer does not end with status 0.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "device_loss.h"
#include "io/codec.h"
#include "io/image.h"
#include "temp_folder.h"
#include "viewer_process.h"
#include "x_server.h"

namespace quintet::test {
namespace {

using testing::HasSubstr;
using testing::Not;

using Rgb = std::array<int, 3>;

constexpr const char* kScene = R"(
[[material]]
name = "paint"
base_color = [0.1, 0.6, 0.2]
metallic = 0
roughness = 1

[[mesh]]
name = "wall"
positions = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
indices = [[0, 1, 2], [0, 2, 3]]
material = "paint"

[[instance]]
of = "wall"

[[camera]]
look_from = [0, 0, 4]
look_at = [0, 0, 0]
fov = 40
)";

// One color for all pixels.
std::string flatProgram(const std::string& expression) {
  return "/**** COMMON START ****/\n"
         "uniform vec3 tint;  // defaultval=\"1.0, 0.0, 0.0\" type=\"color\"\n"
         "uniform bool swapped;  // defaultval=\"false\"\n"
         "/**** COMMON END ****/\n"
         "void main() { /**** RAY GENERATION SHADER ****/\n"
         "  vec3 color = swapped ? tint.bgr : tint;\n"
         "  gsnSetPixel(vec4(" +
         expression + ", 1.0));\n}\n";
}

class WindowTest : public testing::Test {
 protected:
  WindowTest() {
    writeFile(folder_ / "wall.scene.toml", kScene);
    writeFile(folder_ / "flat.rt.glsl", flatProgram("color"));
  }

  ViewerProcess& start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"--window-size", windowSize_});
    viewer_ = std::make_unique<ViewerProcess>(server_, folder_.path(), arguments, environment_);
    return *viewer_;
  }
  // The window loses this number of devices once the file "lose" exists.
  void loseDevices(DeviceLoss::Kind kind, unsigned count) {
    environment_ = environmentOf({.kind = kind, .trigger = folder_ / "lose", .count = count});
  }
  // Only these panels are open, so that their controls are visible.
  void openPanels(const std::string& names) {
    std::filesystem::create_directories(folder_ / "config/quintet");
    writeFile(folder_ / "config/quintet/viewer.json", R"({"openPanels": [)" + names + "]}");
  }
  ViewerProcess& startScene(const std::string& program, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"wall.scene.toml", "--program", program, "--spp", "4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ViewerProcess& viewer = start(arguments);
    viewer.waitForImage();
    viewer.settle();
    return viewer;
  }

  // Mean color of a square of 9 x 9 pixels.
  static Rgb colorAt(const io::Image& shot, int x, int y) {
    Rgb sum{};
    for (int v = y - 4; v <= y + 4; ++v)
      for (int u = x - 4; u <= x + 4; ++u)
        for (std::size_t c = 0; c < 3; ++c)
          sum[c] += shot.pixel<std::uint8_t>(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v))[c];
    for (int& value : sum) value = (value + 40) / 81;
    return sum;
  }
  // In the middle of the image. With QUINTET_SCREENSHOTS=FOLDER, screenshots are also stored there.
  Rgb imageColor() {
    const io::Image shot = viewer_->window().screenshot();
    if (const char* folder = std::getenv("QUINTET_SCREENSHOTS"))
      io::writeImage(
          std::filesystem::path(folder) / (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) +
                                           "-" + std::to_string(shots_++) + ".png"),
          shot);
    const auto [left, top, right, bottom] = viewer_->imageArea();
    return colorAt(shot, (left + right) / 2, (top + bottom) / 2);
  }
  static bool isClose(const Rgb& a, const Rgb& b, int tolerance = 3) {
    for (std::size_t c = 0; c < 3; ++c)
      if (std::abs(a[c] - b[c]) > tolerance) return false;
    return true;
  }
  void expectColor(const Rgb& expected, const std::string& what) {
    viewer_->settle();
    const Rgb color = imageColor();
    EXPECT_TRUE(isClose(color, expected))
        << what << ": " << testing::PrintToString(color) << " instead of " << testing::PrintToString(expected);
  }
  // In the lower half of the image, where there are no messages.
  int differentPixels(const io::Image& a, const io::Image& b) {
    const auto [left, top, right, bottom] = viewer_->imageArea();
    int count = 0;
    for (int y = (top + bottom) / 2; y < bottom; ++y)
      for (int x = left; x < right; ++x) {
        const auto u = static_cast<std::uint32_t>(x), v = static_cast<std::uint32_t>(y);
        count += !std::ranges::equal(a.pixel<std::uint8_t>(u, v), b.pixel<std::uint8_t>(u, v));
      }
    return count;
  }
  std::pair<int, int> imageCenter() {
    const auto [left, top, right, bottom] = viewer_->imageArea();
    return {(left + right) / 2, (top + bottom) / 2};
  }

  // Runs a command that writes image.png. Returns the largest difference from the window, in the lower half of the
  // image, where there are no messages.
  int largestDifference(const std::string& command) {
    const std::string line = "cd '" + folder_.path().string() + "' && PATH='" + QUINTET_BINARY_FOLDER +
                             "':\"$PATH\" && " + command + " > output.txt 2>&1";
    EXPECT_EQ(std::system(line.c_str()), 0) << command << readTextFile(folder_ / "output.txt");
    const io::Image rendered = io::readImage(folder_ / "image.png");
    const io::Image shot = viewer_->window().screenshot();
    const auto [left, top, right, bottom] = viewer_->imageArea();
    EXPECT_EQ(rendered.width, static_cast<std::uint32_t>(right - left));
    EXPECT_EQ(rendered.height, static_cast<std::uint32_t>(bottom - top));
    int largest = 0;
    for (int y = (top + bottom) / 2; y < bottom; ++y)
      for (int x = left; x < right; ++x)
        for (std::size_t c = 0; c < 3; ++c) {
          const int a = rendered.pixel<std::uint8_t>(static_cast<std::uint32_t>(x - left),
                                                     static_cast<std::uint32_t>(y - top))[c];
          const int b = shot.pixel<std::uint8_t>(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))[c];
          largest = std::max(largest, std::abs(a - b));
        }
    return largest;
  }

  void TearDown() override {
    if (!viewer_) return;
    if (viewer_->running()) viewer_->window().close();
    const ViewerProcess::End end = viewer_->finish();
    EXPECT_EQ(end.status, 0) << end.errors;
    EXPECT_THAT(end.errors, Not(HasSubstr("Vulkan validation")));
    EXPECT_THAT(end.errors, Not(HasSubstr("Sanitizer")));
    EXPECT_THAT(end.errors, Not(HasSubstr("runtime error:"))) << "of the sanitizer of undefined behavior";
  }

  TempFolder folder_;
  XServer server_;
  std::unique_ptr<ViewerProcess> viewer_;
  std::vector<std::pair<std::string, std::string>> environment_;  // of the process, additionally
  std::string windowSize_ = "720x480";
  int shots_ = 0;
};

constexpr Rgb kRed{255, 0, 0}, kGreen{0, 255, 0}, kBlue{0, 0, 255};
constexpr Rgb kFacing{174, 174, 240};  // of the program `normals`, tone mapped, for a surface that faces +z

TEST_F(WindowTest, StartsEmptyAndQuits) {
  ViewerProcess& viewer = start({});
  viewer.control("Help");
  viewer.window().key("question", {"Shift_L"});
  viewer.settle();
  EXPECT_TRUE(viewer.running());
  viewer.window().key("q", {"Control_L"});
  EXPECT_EQ(viewer.finish().status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "config/quintet/viewer.json")) << "the settings are stored";
}

TEST_F(WindowTest, KeepsFilesThatItCannotRead) {
  const std::filesystem::path folder = folder_ / "config/quintet";
  const std::string bookmarks = R"({"/a.glb": [{"name": "Side", "up": [0, 1, 0]}]})";
  std::filesystem::create_directories(folder);
  writeFile(folder / "viewer.json", "{");
  writeFile(folder / "bookmarks.json", bookmarks);
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  EXPECT_EQ(readTextFile(folder / "viewer.json.invalid"), "{");
  viewer.window().key("b");
  viewer.settle();
  const Json stored = Json::parse(readTextFile(folder / "bookmarks.json"));
  EXPECT_EQ(stored.at("/a.glb").at(0).at("name"), "Side");
  EXPECT_EQ(stored.at((folder_ / "wall.scene.toml").string()).size(), 1u);
  // Another window adds one.
  Json other = stored;
  other["/b.glb"] = other["/a.glb"];
  writeFile(folder / "bookmarks.json", other.dump());
  viewer.window().key("b");
  viewer.settle();
  const Json both = Json::parse(readTextFile(folder / "bookmarks.json"));
  EXPECT_EQ(both.at((folder_ / "wall.scene.toml").string()).size(), 2u);
  EXPECT_EQ(both.count("/b.glb"), 1u);
}

TEST_F(WindowTest, OrbitsAndUndoes) {
  ViewerProcess& viewer = startScene("normals");
  expectColor(kFacing, "the wall from the front");
  const io::Image front = viewer.window().screenshot();
  const auto [x, y] = imageCenter();
  viewer.window().drag(x, y, x + 60, y);
  viewer.waitFor("restarted");
  viewer.waitForImage();
  expectColor(kFacing, "the color depends on the world, not on the camera");
  const io::Image turned = viewer.window().screenshot();
  EXPECT_GT(differentPixels(front, turned), 1000) << "the outline moves";
  viewer.window().key("z", {"Control_L"});
  viewer.waitForImage();
  viewer.settle();
  EXPECT_EQ(differentPixels(front, viewer.window().screenshot()), 0) << "undo leads to the same pixels";
  viewer.window().key("Z", {"Control_L", "Shift_L"});
  viewer.waitForImage();
  viewer.settle();
  EXPECT_EQ(differentPixels(turned, viewer.window().screenshot()), 0) << "so does redo";
}

TEST_F(WindowTest, ZoomsWithTheWheelAndFramesTheScene) {
  ViewerProcess& viewer = startScene("normals");
  const auto [x, y] = imageCenter();
  const auto corner = [&] {
    viewer.settle();
    const auto [left, top, right, bottom] = viewer.imageArea();
    return colorAt(viewer.window().screenshot(), left + 8, bottom - 8);
  };
  EXPECT_FALSE(isClose(corner(), kFacing)) << "the corner shows the background";
  viewer.window().move(x, y);
  for (int i = 0; i < 8; ++i) {
    viewer.window().press(4);
    viewer.window().release(4);
  }
  viewer.waitForImage();
  EXPECT_TRUE(isClose(corner(), kFacing)) << "closer, the wall fills the image";
  viewer.window().key("Home");
  viewer.waitForImage();
  EXPECT_FALSE(isClose(corner(), kFacing)) << "Home shows the scene";
  expectColor(kFacing, "with the wall in its middle");
}

TEST_F(WindowTest, ChangesAParameter) {
  openPanels(R"("Parameters")");
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  expectColor(kRed, "the default");
  viewer.clickControl("Parameters/swapped");
  viewer.waitForImage();
  expectColor(kBlue, "the parameter is set");
  viewer.window().key("z", {"Control_L"});
  viewer.waitForImage();
  expectColor(kRed, "undone");
}

TEST_F(WindowTest, AddsUpStepsOfExposure) {
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  for (int i = 0; i < 6; ++i) viewer.window().key("minus");
  viewer.settle();
  viewer.window().key("c", {"Control_L"});
  viewer.settle();
  EXPECT_THAT(viewer.window().clipboard(), HasSubstr("--exposure -2"));
}

// A red triangle that covers the image; the variant "night" is green.
constexpr const char* kVariants = R"({
"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1]}],
"nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 4]}],
"cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
"buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAQwQAAEMEAAAAAAAAQQQAAEMEAAAAAAAAAAAAAkEEAAAAA"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-9, -9, 0], "max": [9, 18, 0]}],
"materials": [
  {"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}, "extensions": {"KHR_materials_unlit": {}}},
  {"pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0, 1]}, "extensions": {"KHR_materials_unlit": {}}}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0,
  "extensions": {"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [0]}]}}}]}],
"extensions": {"KHR_materials_variants": {"variants": [{"name": "night"}]}},
"extensionsUsed": ["KHR_materials_unlit", "KHR_materials_variants"]})";

TEST_F(WindowTest, ChoosesAMaterialVariant) {
  writeFile(folder_ / "day.gltf", kVariants);
  openPanels(R"("Scene")");
  ViewerProcess& viewer = start({"day.gltf", "--spp", "4", "--env", "none"});
  viewer.waitForImage();
  viewer.settle();
  const Rgb day = imageColor();
  EXPECT_GT(day[0], day[1] + 100) << testing::PrintToString(day);
  viewer.window().key("minus");  // an exposure, which stays
  viewer.clickControl("Scene/Variant");
  viewer.settle();
  viewer.clickControl("Scene/Variant/night");
  viewer.waitForImage();
  viewer.settle();
  const Rgb night = imageColor();
  EXPECT_GT(night[1], night[0] + 100) << testing::PrintToString(night);
  viewer.window().key("c", {"Control_L"});
  viewer.settle();
  EXPECT_THAT(viewer.window().clipboard(), HasSubstr("--variant night"));
  EXPECT_THAT(viewer.window().clipboard(), HasSubstr("--exposure -0.333"));
}

TEST_F(WindowTest, SelectsAnObjectAndEditsItsMaterial) {
  openPanels(R"("Selection")");
  windowSize_ = "720x900";  // for all properties
  ViewerProcess& viewer = startScene("pathtracer", {"--env", "none", "--set", "bounces=0"});
  expectColor({0, 0, 0}, "no light");
  const auto [x, y] = imageCenter();
  viewer.window().click(x, y);
  viewer.clickControl("Selection/Unlit");
  viewer.waitForImage();
  viewer.settle();
  const Rgb color = imageColor();
  EXPECT_GT(color[1], 120) << "the base color is the radiance";
  EXPECT_GT(color[1], color[0] + 40);
  EXPECT_GT(color[1], color[2] + 40);
  viewer.window().key("c", {"Control_L"});
  viewer.settle();
  const std::string command = viewer.window().clipboard();
  EXPECT_THAT(command, HasSubstr("\"do\":\"material\""));
  viewer.window().key("Escape");  // removes the box around the object
  viewer.settle();
  EXPECT_LE(largestDifference(command), 1) << "the script repeats the edit";
}

TEST_F(WindowTest, EscapeClosesOnlyTheMenu) {
  openPanels(R"("Selection")");
  ViewerProcess& viewer = startScene("normals");
  const auto [x, y] = imageCenter();
  viewer.window().click(x, y);
  viewer.control("Selection/Show");
  viewer.clickControl("Edit");
  viewer.control("Undo");
  viewer.window().key("Escape");
  viewer.settle();
  EXPECT_FALSE(viewer.hasControl("Undo")) << "the menu is closed";
  EXPECT_TRUE(viewer.hasControl("Selection/Show")) << "the selection stays";
  viewer.window().key("Escape");
  viewer.settle();
  EXPECT_FALSE(viewer.hasControl("Selection/Show"));
}

TEST_F(WindowTest, NamesTheStepsOfUndo) {
  openPanels(R"("Parameters")");
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  viewer.clickControl("Parameters/swapped");
  viewer.waitForImage();
  viewer.clickControl("Edit");
  viewer.control("Undo parameter 'swapped'");
  viewer.window().key("Escape");
  viewer.window().key("z", {"Control_L"});
  viewer.waitForImage();
  viewer.control("undone: parameter 'swapped'");
  viewer.clickControl("Edit");
  viewer.control("Redo parameter 'swapped'");
  viewer.window().key("Escape");
}

// The keys arrive faster than the window draws frames, and before the field has the focus.
TEST_F(WindowTest, LosesNoKeysOfAFastTypist) {
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  viewer.window().key("s", {"Control_L"});
  viewer.window().typeFast({"a", "s", "s", "BackSpace", "BackSpace", "BackSpace", "s", "h", "o", "o", "t", "period",
                            "p", "n", "g", "Return"});
  EXPECT_THAT(viewer.waitFor("saved")["file"].get<std::string>(), HasSubstr("shoot.png"));
}

TEST_F(WindowTest, FiltersWhileTheUserTypes) {
  std::string scene = kScene;
  for (int i = 0; i < 24; ++i)
    scene += "\n[[instance]]\nof = \"wall\"\nname = \"" + std::string(i == 20 ? "lamp" : "panel") + std::to_string(i) +
             "\"\ntranslate = [0, 0, -" + std::to_string(i + 1) + "]\n";
  writeFile(folder_ / "wall.scene.toml", scene);
  openPanels(R"("Scene")");
  ViewerProcess& viewer = startScene("normals");
  viewer.control("Scene/panel0");
  viewer.clickControl("Scene/Filter");
  viewer.settle();
  for (const char* key : {"l", "a", "m"}) viewer.window().key(key);
  viewer.control("Scene/lamp20");
  viewer.settle();
  EXPECT_FALSE(viewer.hasControl("Scene/panel0")) << "without Enter";
}

TEST_F(WindowTest, TheEdgeOfThePanelsChangesTheirWidth) {
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  const int before = viewer.imageArea()[2];
  const auto [left, top, right, bottom] = viewer.control("Edge of the panels");
  const int x = (left + right) / 2, y = (top + bottom) / 2;
  viewer.window().move(x, y);
  viewer.settle();
  viewer.window().press(1);
  viewer.settle();
  viewer.window().move(x + 60, y);
  viewer.settle();
  viewer.window().release(1);
  viewer.settle();
  EXPECT_NEAR(viewer.imageArea()[2], before + 60, 6);
  EXPECT_THAT(readTextFile(folder_ / "config/quintet/viewer.json"), HasSubstr("\"panelWidth\": 29")) << "is stored";
}

TEST_F(WindowTest, KeepsTheSamplesIfTheWindowChanges) {
  ViewerProcess& viewer = start({"wall.scene.toml", "--program", "normals", "--spp", "1000000"});
  const auto isFull = [](const Json& event) { return event["event"] == "image" && event["factor"] == 1; };
  const Json first = viewer.waitFor(isFull);
  std::this_thread::sleep_for(std::chrono::seconds(6));  // so that much would be lost
  viewer.window().key("Tab");
  viewer.window().resize(760, 500);
  std::this_thread::sleep_for(std::chrono::seconds(2));
  const auto [left, top, right, bottom] = viewer.imageArea();
  EXPECT_EQ(right, 760) << "no panels";
  const std::string button = "Render at 760 \u00d7 " + std::to_string(bottom - top);
  viewer.control(button);
  Json last = first;
  const auto isLast = [&](const Json& event) {
    EXPECT_NE(event["event"], "restarted") << "the samples stay";
    if (event["event"] == "image") last = event;
    return event["event"] == "image" && event["samples"].get<int>() > 2 * first["samples"].get<int>();
  };
  viewer.waitFor(isLast);
  EXPECT_EQ(last["width"], first["width"]) << "scaled";
  imageColor();  // a screenshot
  viewer.window().key("0");
  viewer.waitFor([](const Json& event) { return event["event"] == "image" && event["width"] == 760; });
  std::this_thread::sleep_for(std::chrono::seconds(1));
  EXPECT_FALSE(viewer.hasControl(button));
}

TEST_F(WindowTest, MarksPixelsThatAreNotFinite) {
  writeFile(folder_ / "flat.rt.glsl", flatProgram("sqrt(color - 2.0)"));
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  expectColor({255, 0, 255}, "NaN");
  const auto [left, top, right, bottom] = viewer.imageArea();
  viewer.control(std::to_string((right - left) * (bottom - top)) + " pixels are NaN or infinite");
}

// A save ends the hang: the process replaces itself, and with it the threads of the driver.
TEST_F(WindowTest, OpensTheProgramAgainAfterAHang) {
  openPanels(R"("Parameters")");
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  viewer.clickControl("Parameters/swapped");
  viewer.waitForImage();
  expectColor(kBlue, "the parameter is set");
  const std::string endless = "vec3(endless(color.b))";
  std::string program = flatProgram(endless);
  program.insert(program.find("/**** COMMON END"),
                 "float endless(float x) { while (x < 2.0) x = fract(x + 0.37); return x; }\n");
  writeFile(folder_ / "flat.rt.glsl", program);
  viewer.control("Waiting");
  viewer.control("Stop");
  imageColor();  // a screenshot
  writeFile(folder_ / "flat.rt.glsl", flatProgram("color.gbr"));
  viewer.waitForImage();
  viewer.findWindowAgain();
  viewer.settle();
  expectColor(kGreen, "the repaired version, with the value of the parameter");
}

// Stop opens the scene again after a save, and a window whose work hangs can be closed.
TEST_F(WindowTest, StopsAndClosesDuringAHang) {
  std::string program = flatProgram("vec3(endless(color.r))");
  program.insert(program.find("/**** COMMON END"),
                 "float endless(float x) { while (x < 2.0) x = fract(x + 0.37); return x; }\n");
  writeFile(folder_ / "flat.rt.glsl", program);
  ViewerProcess& viewer = start({"wall.scene.toml", "--program", "flat.rt.glsl", "--spp", "4"});
  EXPECT_GE(viewer.control("Stop")[0], viewer.imageArea()[0]) << "the note has room over a narrow image";
  viewer.settle();  // the note has just become larger
  viewer.clickControl("Stop");
  viewer.control("Try again");
  viewer.findWindowAgain();
  imageColor();  // a screenshot
  viewer.clickControl("Try again");
  viewer.control("Stop");
  viewer.window().close();
  EXPECT_EQ(viewer.finish().status, 0);
}

TEST_F(WindowTest, ReportsABrokenShaderAndContinues) {
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  expectColor(kRed, "the first version");
  writeFile(folder_ / "flat.rt.glsl", flatProgram("missing"));
  const Json found = viewer.waitFor("diagnostics");
  EXPECT_THAT(found.dump(), HasSubstr("flat.rt.glsl"));
  EXPECT_THAT(found.dump(), HasSubstr("missing"));
  viewer.control("×");  // of the panel with the diagnostics
  viewer.settle();
  const io::Image shot = viewer.window().screenshot();
  const auto [left, top, right, bottom] = viewer.imageArea();
  EXPECT_TRUE(isClose(colorAt(shot, (left + right) / 2, top + 20), kRed)) << "the last version that compiles";
  EXPECT_FALSE(isClose(colorAt(shot, (left + right) / 2, bottom - 20), kRed)) << "the panel with the diagnostics";
  writeFile(folder_ / "flat.rt.glsl", flatProgram("color.grb"));
  viewer.waitFor("reloaded");
  viewer.waitForImage();
  expectColor(kGreen, "the corrected version");
  EXPECT_FALSE(viewer.hasControl("×")) << "no diagnostics any more";
}

TEST_F(WindowTest, SurvivesSizesAndMinimizing) {
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  for (const auto& [width, height] :
       {std::pair{1u, 1u}, std::pair{2u, 300u}, std::pair{300u, 1u}, std::pair{40u, 40u}}) {
    viewer.window().resize(width, height);
    viewer.settle();
    ASSERT_TRUE(viewer.running()) << width << "x" << height;
  }
  viewer.window().hide();
  viewer.settle();
  ASSERT_TRUE(viewer.running());
  viewer.window().show();
  viewer.window().resize(800, 500);
  viewer.waitFor([](const Json& event) { return event["event"] == "image" && event["height"] > 300; });
  expectColor(kRed, "large again");
  viewer.window().resize(720, 480);
  for (unsigned size = 200; size < 700; size += 13) viewer.window().resize(size, 700 - size / 2);
  viewer.window().resize(720, 480);
  viewer.waitForImage();
  expectColor(kRed, "after many changes");
}

TEST_F(WindowTest, OpensDroppedFiles) {
  ViewerProcess& viewer = start({});
  viewer.control("Help");
  const auto drop = [&](const char* name) { return viewer.window().drop((folder_ / name).string(), 300, 200); };
  const auto copiedCommand = [&] {
    viewer.window().key("c", {"Control_L"});
    viewer.settle();
    return viewer.window().clipboard();
  };
  EXPECT_TRUE(drop("flat.rt.glsl"));
  viewer.waitForImage();
  expectColor(kRed, "the program");
  EXPECT_TRUE(drop("wall.scene.toml"));
  viewer.waitForImage();
  expectColor(kRed, "the program stays with the scene");
  EXPECT_THAT(copiedCommand(), HasSubstr("wall.scene.toml"));
  std::string blue = flatProgram("color.bgr");
  writeFile(folder_ / "blue.rt.glsl", blue);
  EXPECT_TRUE(drop("blue.rt.glsl"));
  viewer.waitForImage();
  expectColor(kBlue, "another program for the scene");
  viewer.window().key("z", {"Control_L"});
  viewer.waitForImage();
  expectColor(kRed, "undo brings back the program");
  writeFile(folder_ / "notes.txt", "no scene");
  EXPECT_TRUE(drop("notes.txt"));
  viewer.control((folder_ / "notes.txt").string() +
                 ": neither a scene (.glb, .gltf, .scene.toml), a program (.rt.glsl, a folder with program.toml), an "
                 "image nor an explanation (.json)");
  // The failure is shown without panels, so the window has room for a larger image.
  writeFile(folder_ / "broken.scene.toml", "[[mesh");
  EXPECT_TRUE(drop("broken.scene.toml"));
  viewer.control("Try again");
  viewer.settle();
  EXPECT_TRUE(drop("wall.scene.toml"));
  viewer.waitFor([&](const Json& event) {
    const auto [left, top, right, bottom] = viewer.imageArea();
    return event["event"] == "image" && event["complete"] == true && event["width"] == right - left &&
           event["height"] == bottom - top && right < 700;
  });
  io::Image sky = io::makeImage(4, 2, 3, io::PixelType::f32, io::ColorEncoding::linear);
  io::writeImage(folder_ / "sky.hdr", sky);
  EXPECT_TRUE(drop("sky.hdr"));
  viewer.waitForImage();
  expectColor(kRed, "the program does not show the environment");
  EXPECT_THAT(copiedCommand(), HasSubstr("sky.hdr"));
}

TEST_F(WindowTest, AsksBeforeItReplacesAFile) {
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  writeFile(folder_ / "wall.scene.png", "a texture");
  viewer.window().key("s", {"Control_L"});
  viewer.control("Save");
  viewer.window().key("Return");
  viewer.settle();
  EXPECT_TRUE(viewer.hasControl("Save")) << "the dialog stays open";
  EXPECT_EQ(readTextFile(folder_ / "wall.scene.png"), "a texture");
  viewer.clickControl("Save");
  viewer.waitFor("saved");
  EXPECT_GT(io::readImage(folder_ / "wall.scene.png").width, 100u);
}

TEST_F(WindowTest, CopiesTheCommandThatRendersTheImage) {
  ViewerProcess& viewer = startScene("normals");
  const auto [x, y] = imageCenter();
  viewer.window().drag(x, y, x + 40, y - 30);
  viewer.waitForImage();
  viewer.settle();
  viewer.window().key("c", {"Control_L"});
  viewer.settle();
  const std::string command = viewer.window().clipboard();
  EXPECT_THAT(command, testing::StartsWith("quintet render wall.scene.toml -o image.png --program normals"));
  EXPECT_LE(largestDifference(command), 1) << "the window shows what the command renders";
}

TEST_F(WindowTest, ShowsFalseColorWithALegend) {
  openPanels(R"("Display")");
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  expectColor(kRed, "the color");
  viewer.clickControl("Display/False color");
  viewer.settle();
  const Rgb color = imageColor();  // of luminance 0.2126 in [0,1]
  EXPECT_TRUE(isClose(color, {63, 71, 136}, 4)) << testing::PrintToString(color);
  const auto [left, top, right, bottom] = viewer.imageArea();
  EXPECT_FALSE(isClose(colorAt(viewer.window().screenshot(), left + 30, bottom - 60), color)) << "the legend";
}

TEST_F(WindowTest, ShowsHeatInFalseColors) {
  ViewerProcess& viewer = startScene("normals");
  viewer.window().key("Prior");  // the last output: the number of intersection shader calls, which is 0
  viewer.waitForImage();
  expectColor({68, 1, 84}, "the color of 0");
}

TEST_F(WindowTest, ComparesWithADroppedImage) {
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  io::Image reference = io::makeImage(8, 8, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  for (std::size_t i = 1; i < reference.sampleCount(); i += 3) reference.samples<std::uint8_t>()[i] = 255;
  io::writeImage(folder_ / "reference.png", reference);
  EXPECT_TRUE(viewer.window().drop((folder_ / "reference.png").string(), 200, 200));
  viewer.settle();
  const io::Image shot = viewer.window().screenshot();
  const auto [left, top, right, bottom] = viewer.imageArea();
  const int y = (top + 2 * bottom) / 3;
  EXPECT_TRUE(isClose(colorAt(shot, left + 20, y), kRed)) << "the image to the left of the line";
  EXPECT_TRUE(isClose(colorAt(shot, right - 20, y), kGreen)) << "the reference to the right";
  viewer.control("Compare/scaled");
  // The line is dragged to the left.
  viewer.window().move((left + right) / 2, y);
  viewer.settle();
  viewer.window().press(1);
  viewer.settle();  // a frame of the window sees the press here
  viewer.window().move(left + 60, y);
  viewer.settle();
  viewer.window().release(1);
  viewer.settle();
  EXPECT_TRUE(isClose(colorAt(viewer.window().screenshot(), left + 90, y), kGreen));
  viewer.window().key("x");
  expectColor(kRed, "no comparison");
}

// A render in linear values is a reference, although such files can be environments.
TEST_F(WindowTest, ComparesWithFilesOfLinearValues) {
  openPanels(R"("Compare")");
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  const auto [left, top, right, bottom] = viewer.imageArea();
  const auto writeGreen = [&](const char* name, int width, int height) {
    io::Image image = io::makeImage(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 3,
                                    io::PixelType::f32, io::ColorEncoding::linear);
    for (std::size_t i = 1; i < image.sampleCount(); i += 3) image.samples<float>()[i] = 1.0f;
    io::writeImage(folder_ / name, image);
  };
  writeGreen("same.exr", right - left, bottom - top);
  writeGreen("b.hdr", 8, 4);
  EXPECT_TRUE(viewer.window().drop((folder_ / "same.exr").string(), 200, 200));
  viewer.control("Compare/Mode");
  viewer.settle();
  const int y = (top + 2 * bottom) / 3;
  EXPECT_TRUE(isClose(colorAt(viewer.window().screenshot(), right - 20, y), kGreen)) << "the reference";
  EXPECT_FALSE(viewer.hasControl("Compare/scaled"));
  viewer.clickControl("Compare/Remove reference");
  viewer.clickControl("Compare/Choose a file...");
  viewer.control("Open");
  viewer.settle();
  viewer.window().typeFast({"b", "period", "h", "d", "r", "Return"});
  viewer.control("Compare/scaled");
  imageColor();  // a screenshot
}

TEST_F(WindowTest, ExplainsAPixelAndComparesTwo) {
  openPanels(R"("Explain")");
  windowSize_ = "760x1000";  // for all of the panel
  ViewerProcess& viewer = startScene("pathtracer", {"--set", "bounces=1"});
  const auto [x, y] = imageCenter();
  const auto [left, top, right, bottom] = viewer.imageArea();
  const auto press = [&](const char* control) {
    viewer.settle();  // the panel scrolls and grows
    viewer.clickControl(control);
  };
  viewer.window().click(x, y, 1, {"Control_L"});
  const Json explained = viewer.waitFor("explained");
  EXPECT_EQ(explained["x"], x - left);
  EXPECT_EQ(explained["y"], y - top);
  const Json& explanation = explained["explanation"];
  EXPECT_GT(explanation["outputs"][0]["value"][0], 0.0) << "the sky lights the wall";
  press("Explain/Ray 2");
  viewer.control("Explain/details of Ray 2");
  press("Explain/Ray 1/hit");
  viewer.control("Explain/details of hit");
  EXPECT_FALSE(viewer.hasControl("Explain/details of Ray 2"));
  press("Explain/Ray 1/hit");
  viewer.settle();
  EXPECT_FALSE(viewer.hasControl("Explain/details of hit")) << "a second click deselects the row";
  imageColor();  // a screenshot

  press("Explain/Keep as A");
  viewer.control("Explain/equal");
  const auto saved = [&](const char* name) {
    viewer.window().key("e", {"Control_L"});
    press("Save");
    viewer.settle();
    return (folder_ / name).string();
  };
  const std::string before =
      saved(("pixel-" + std::to_string(x - left) + "-" + std::to_string(y - top) + ".json").c_str());
  EXPECT_EQ(Json::parse(readTextFile(before))["events"], explanation["events"]);
  viewer.window().key("i", {"Control_L"});
  viewer.settle();
  const std::string command = viewer.window().clipboard();
  EXPECT_THAT(command, testing::StartsWith("quintet explain-pixel wall.scene.toml --pixel "));
  const std::string same = "cd '" + folder_.path().string() + "' && PATH='" + QUINTET_BINARY_FOLDER +
                           "':\"$PATH\" && " + command + " --against '" + before + "' > output.txt 2>&1";
  EXPECT_EQ(std::system(same.c_str()), 0) << command << readTextFile(folder_ / "output.txt");

  viewer.window().drag(x, y, x + 30, y);
  viewer.waitForImage();
  press("Explain/Explain again");
  EXPECT_NE(viewer.waitFor("explained")["explanation"]["events"], explanation["events"]);
  viewer.control("Explain/first difference");
  EXPECT_FALSE(viewer.hasControl("Explain/equal"));
  imageColor();
  press("Explain/Forget A");
  viewer.settle();
  EXPECT_FALSE(viewer.hasControl("Explain/first difference"));
  EXPECT_TRUE(viewer.window().drop(before, 200, 200));
  viewer.control("Explain/first difference");
  viewer.window().key("Escape");
  viewer.settle();
  EXPECT_FALSE(viewer.hasControl("Explain/Ray 1")) << "Escape hides the explanation";
  EXPECT_TRUE(viewer.hasControl("Explain/Forget A")) << "A stays";
}

TEST_F(WindowTest, DrawsTheRaysOfTheExplainedPixel) {
  openPanels(R"("Explain")");
  windowSize_ = "760x960";  // for all of the panel
  ViewerProcess& viewer = startScene("pathtracer", {"--set", "bounces=1"});
  const auto [x, y] = imageCenter();
  EXPECT_FALSE(viewer.hasControl("Legend of rays"));
  viewer.window().click(x, y, 1, {"Control_L"});
  viewer.waitFor("explained");
  viewer.control("Legend of rays");

  // From the side, the camera ray is a white line. V hides it. On a busy machine, the first images after the drag can show
  // only a part of the turn.
  viewer.window().drag(x, y, x + 110, y);
  viewer.waitForImage();
  const auto [left, top, right, bottom] = viewer.imageArea();
  const auto distance = [x = x, y = y](const std::pair<int, int>& p) { return std::hypot(p.first - x, p.second - y); };
  std::pair<int, int> farthest{x, y};
  int white = 0;
  for (int attempt = 0; attempt < 20 && (white <= 60 || distance(farthest) <= 40.0); ++attempt) {
    viewer.settle();
    imageColor();
    const io::Image rays = viewer.window().screenshot();
    const auto legend = viewer.control("Legend of rays");
    viewer.window().key("v");
    viewer.settle();
    EXPECT_FALSE(viewer.hasControl("Legend of rays"));
    const io::Image plain = viewer.window().screenshot();
    white = 0;
    for (int v = top; v < bottom; ++v)
      for (int u = left; u < right - 8; ++u) {  // a click beside it would grab the edge of the panels
        const auto column = static_cast<std::uint32_t>(u), row = static_cast<std::uint32_t>(v);
        const auto with = rays.pixel<std::uint8_t>(column, row), without = plain.pixel<std::uint8_t>(column, row);
        if (std::min({with[0], with[1], with[2]}) < 255 || std::min({without[0], without[1], without[2]}) == 255)
          continue;
        if (u >= legend[0] && v >= legend[1]) continue;
        ++white;
        if (distance({u, v}) > distance(farthest)) farthest = {u, v};
      }
    viewer.window().key("v");
    viewer.control("Legend of rays");
  }
  EXPECT_GT(white, 60);
  ASSERT_GT(distance(farthest), 40.0);
  EXPECT_FALSE(viewer.hasControl("Explain/details of Ray 1"));
  viewer.window().click(farthest.first, farthest.second);
  viewer.control("Explain/details of Ray 1");
  imageColor();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // not a double click
  viewer.window().click(farthest.first, farthest.second);
  viewer.settle();
  EXPECT_FALSE(viewer.hasControl("Explain/details of Ray 1")) << "a second click deselects the ray";
  viewer.window().key("Escape");
  viewer.settle();
  EXPECT_FALSE(viewer.hasControl("Legend of rays"));
}

TEST_F(WindowTest, ShowsWhatAProgramPrints) {
  openPanels(R"("Printed")");
  writeFile(folder_ / "flat.rt.glsl", flatProgram("color").insert(flatProgram("color").rfind("}\n"),
                                                                  "  debugPrintfEXT(\"frame %d\", frameID);\n"));
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  EXPECT_FALSE(viewer.hasControl("Printed/lines"));
  const auto [x, y] = imageCenter();
  viewer.window().move(x, y);
  viewer.settle();
  viewer.window().key("p");
  const Json printed = viewer.waitFor("printed");
  EXPECT_EQ(printed["lines"].size(), 1u);
  EXPECT_EQ(printed["lines"][0]["text"], "frame 0");
  viewer.waitForImage();
  viewer.control("Printed/lines");
  viewer.settle();
  imageColor();
  viewer.clickControl("Printed/Stop");
  viewer.waitForImage();
  viewer.settle();
  EXPECT_FALSE(viewer.hasControl("Printed/lines"));
}

TEST_F(WindowTest, PlaysAnAnimation) {
  std::string scene = kScene;
  scene.insert(scene.find("[[camera]]"),
               "keyframes = [{ frame = 0, translate = [0, 0, 0] }, { frame = 1000, translate = [0, 0, 0] }]\n");
  writeFile(folder_ / "wall.scene.toml", scene);
  ViewerProcess& viewer = startScene("normals");
  viewer.control("Play");
  viewer.window().key("space");
  viewer.control("Pause");
  for (int i = 0; i < 3; ++i) viewer.waitFor("image");
  viewer.window().key("space");
  viewer.control("Play");
  viewer.waitForImage();
  expectColor(kFacing, "the animation has stopped");
}

TEST_F(WindowTest, KeepsBookmarksAndSettings) {
  ViewerProcess& viewer = startScene("normals");
  viewer.window().key("b");
  viewer.window().key("l");
  viewer.settle();
  viewer.window().close();
  EXPECT_EQ(viewer.finish().status, 0);
  EXPECT_THAT(readTextFile(folder_ / "config/quintet/bookmarks.json"), HasSubstr("Bookmark 1"));
  const std::string settings = readTextFile(folder_ / "config/quintet/viewer.json");
  EXPECT_THAT(settings, HasSubstr("\"theme\": \"light\""));
  EXPECT_THAT(settings, HasSubstr("wall.scene.toml")) << "a recent file";
}

TEST_F(WindowTest, RendersAgainAfterTheLossOfItsDevice) {
  loseDevices(DeviceLoss::Kind::rendering, 2);
  openPanels(R"("Parameters")");
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  expectColor(kRed, "the default");
  viewer.clickControl("Parameters/swapped");
  viewer.waitForImage();
  writeFile(folder_ / "lose", "");
  viewer.window().key("Home");
  for (int i = 0; i < 2; ++i) viewer.waitFor("deviceReplaced");
  viewer.waitForImage();
  expectColor(kBlue, "the edit stays");
  viewer.window().key("z", {"Control_L"});  // the camera
  viewer.window().key("z", {"Control_L"});
  viewer.waitForImage();
  expectColor(kRed, "so do the steps of undo");
}

TEST_F(WindowTest, WaitsForAChangeIfTheDeviceIsLostRepeatedly) {
  loseDevices(DeviceLoss::Kind::rendering, 3);
  ViewerProcess& viewer = startScene("normals");
  const io::Image before = viewer.window().screenshot();
  writeFile(folder_ / "lose", "");
  viewer.window().key("Home");
  const Json error = viewer.waitFor("error");
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("the device was lost 3 times in sequence"));
  viewer.settle();
  EXPECT_EQ(differentPixels(before, viewer.window().screenshot()), 0) << "the last image stays";
  viewer.window().key("z", {"Control_L"});
  viewer.waitForImage();
  viewer.settle();
  EXPECT_EQ(differentPixels(before, viewer.window().screenshot()), 0) << "the same view again";
}

TEST_F(WindowTest, OpensTheDeviceThatDrawsItAgain) {
  loseDevices(DeviceLoss::Kind::presenting, 2);
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  writeFile(folder_ / "lose", "");
  viewer.window().key("minus");
  viewer.settle();
  expectColor({230, 0, 0}, "with less exposure");
  EXPECT_TRUE(viewer.hasControl("the device that draws the window was lost and opened again"));
}

TEST_F(WindowTest, EndsIfNoDeviceCanDrawIt) {
  loseDevices(DeviceLoss::Kind::presenting, 100);
  ViewerProcess& viewer = startScene("flat.rt.glsl");
  viewer.window().key("l");
  viewer.settle();
  writeFile(folder_ / "lose", "");
  viewer.window().key("minus");
  const ViewerProcess::End end = viewer.finish();
  viewer_.reset();
  EXPECT_EQ(end.status, 1);
  EXPECT_THAT(end.errors,
              testing::MatchesRegex("quintet: the window cannot be drawn: [^\n]*VK_ERROR_DEVICE_LOST[^\n]*\n"));
  EXPECT_THAT(readTextFile(folder_ / "config/quintet/viewer.json"), HasSubstr("\"theme\": \"light\""));
}

TEST_F(WindowTest, ShowsFailuresOfLoading) {
  ViewerProcess& viewer = start({"missing.glb"});
  viewer.control("Try again");
  writeFile(folder_ / "missing.scene.toml", kScene);
  EXPECT_TRUE(viewer.window().drop((folder_ / "missing.scene.toml").string(), 100, 100));
  viewer.waitFor("image");
  viewer.settle();
  EXPECT_FALSE(viewer.hasControl("Try again"));
}

}  // namespace
}  // namespace quintet::test
