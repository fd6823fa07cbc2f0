// SPDX-License-Identifier: Apache-2.0
// The camera attributes of OpenEXR files, as oiiotool reads them: they project the position of each pixel to that pixel.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <sstream>

#include "base/file.h"
#include "fixtures.h"
#include "io/exr/exr.h"
#include "render/film/film_file.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;
using Matrix = std::array<double, 16>;  // row by row, for row vectors

constexpr std::uint32_t kWidth = 24, kHeight = 16;

std::array<double, 4> multiply(const std::array<double, 4>& row, const Matrix& m) {
  std::array<double, 4> result{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 4; ++k) result[k] += row[i] * m[4 * i + k];
  return result;
}

class CameraExr : public CliTest {
 protected:
  CameraExr() {
    nlohmann::json scene = quadScene();
    scene["nodes"].push_back({{"mesh", 0}, {"translation", {0.3, -0.2, 0.9}}, {"scale", {0.4, 0.3, 1}}});
    scene["nodes"][1] = {{"camera", 0}, {"translation", {1.4, 0.9, 3.6}}, {"rotation", {-0.12, 0.17, 0.05, 0.977}}};
    scene["scenes"][0]["nodes"].push_back(3);
    write(folder_ / "turned.gltf", scene.dump());
    scene["cameras"][0] = nlohmann::json::parse(
        R"({"type": "orthographic", "orthographic": {"xmag": 1.3, "ymag": 1.1, "znear": 0.1, "zfar": 100}})");
    write(folder_ / "parallel.gltf", scene.dump());
  }

  void render(const std::string& scene, const std::string& output, const std::vector<std::string>& more = {}) {
    std::vector<std::string> all{
        "render", scene, "-q", "--size", "24x16", "--spp", "8", "-o", output, "--aov", "position,instance_id,depth"};
    all.insert(all.end(), more.begin(), more.end());
    const RunResult result = quintet(all);
    ASSERT_EQ(result.status, 0) << result.err;
  }
  std::string info(const std::string& file) {
    const std::string text = (folder_ / "info.txt").string();
    const std::string command = "oiiotool --info -v -a " + (folder_ / file).string() + " > " + text + " 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0) << "(package openimageio-tools: make setup)";
    return readTextFile(text);
  }
  std::optional<Matrix> matrix(const std::string& file, const std::string& name) {
    const std::string text = info(file);
    const std::size_t at = text.find(" " + name + ": ");
    if (at == text.npos) return std::nullopt;
    std::string line = text.substr(at + name.size() + 3, text.find('\n', at) - at - name.size() - 3);
    std::ranges::replace(line, ',', ' ');
    std::istringstream numbers(line);
    Matrix m{};
    for (double& value : m) numbers >> value;
    EXPECT_TRUE(numbers) << line;
    return m;
  }

  // Checks every pixel that shows a surface, and returns their number; -1 without camera attributes.
  int checkProjection(const std::string& file) {
    const io::ExrImage image = io::decodeExr(readFile(folder_ / file), file);
    const auto at = [&](const char* name, std::size_t i) -> double {
      return std::ranges::find(image.channels, name, &io::ExrChannel::name)->samples[i];
    };
    const std::optional<Matrix> toNdc = matrix(file, "worldToNDC"), toCamera = matrix(file, "worldToCamera");
    if (!toNdc || !toCamera) return -1;
    EXPECT_EQ(image.width, kWidth);  // the display window
    EXPECT_EQ(image.height, kHeight);
    int count = 0;
    for (std::size_t i = 0; i < std::size_t{kWidth} * kHeight; ++i) {
      if (at("instance_id.X", i) == 0) continue;
      ++count;
      const std::array<double, 4> world{at("position.X", i), at("position.Y", i), at("position.Z", i), 1};
      const std::array<double, 4> ndc = multiply(world, *toNdc), camera = multiply(world, *toCamera);
      EXPECT_NEAR(ndc[0] / ndc[3] * kWidth, static_cast<double>(i % kWidth) + 0.5, 2e-3) << i;
      EXPECT_NEAR(ndc[1] / ndc[3] * kHeight, static_cast<double>(i / kWidth) + 0.5, 2e-3) << i;
      EXPECT_NEAR(camera[2], at("depth.Z", i), 1e-4) << i;  // positive in front
      EXPECT_EQ(camera[3], 1.0);
    }
    return count;
  }
};

TEST_F(CameraExr, ProjectsPositionsToTheirPixels) {
  for (const char* scene : {"turned.gltf", "parallel.gltf"}) {
    render(scene, "a.exr");
    const int all = checkProjection("a.exr");
    EXPECT_GT(all, 80) << scene;
    EXPECT_LT(all, static_cast<int>(kWidth * kHeight)) << scene;
    const auto whole = matrix("a.exr", "worldToNDC");
    render(scene, "a.exr", {"--region", "7,5,11,6"});
    const int part = checkProjection("a.exr");
    EXPECT_GT(part, 20) << scene;
    EXPECT_LE(part, 11 * 6) << scene;
    EXPECT_EQ(matrix("a.exr", "worldToNDC"), whole) << scene;
  }
}

TEST_F(CameraExr, IsInEveryPartAndEveryFile) {
  render("turned.gltf", "a.exr", {"--exr-compression", "dwaa"});
  const std::string text = info("a.exr");
  EXPECT_THAT(text, HasSubstr("2 subimages"));
  for (const char* name : {" worldToCamera: ", " worldToNDC: "})
    EXPECT_NE(text.find(name, text.find(name) + 1), text.npos) << name;
  const RunResult result = quintet(quick({"-o", "n.exr", "--all-outputs"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(matrix("n.color.exr", "worldToNDC"));
  EXPECT_THAT(quintet({"info", "a.exr"}).out, HasSubstr("worldToCamera "));
}

TEST_F(CameraExr, IsKeptByFilms) {
  const auto removeCamera = [&](const char* name) {
    render::FilmFile file = render::readFilm(folder_ / name);
    EXPECT_EQ(std::erase_if(file.notes, [](const auto& note) { return note.first.starts_with("world to "); }), 2u);
    render::writeFilm(folder_ / name, file);
  };
  const auto merge = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"merge", "-q", "--force"});
    const RunResult result = quintet(arguments);
    ASSERT_EQ(result.status, 0) << result.err;
  };
  render("turned.gltf", "whole.exr", {"--region", "7,5,11,6"});
  render("turned.gltf", "a.qfilm", {"--region", "7,5,11,6", "--batches", "0"});
  render("turned.gltf", "b.qfilm", {"--region", "7,5,11,6", "--batches", "1"});
  const std::vector<std::byte> part = readFile(folder_ / "b.qfilm");
  merge({"a.qfilm", "b.qfilm", "-o", "ab.qfilm"});
  merge({"ab.qfilm", "-o", "ab.exr"});
  const auto expectSameCamera = [&](const char* file) {
    for (const char* name : {"worldToCamera", "worldToNDC"}) {
      EXPECT_TRUE(matrix(file, name)) << file;
      EXPECT_EQ(matrix(file, name), matrix("whole.exr", name)) << file;
    }
  };
  expectSameCamera("ab.exr");
  EXPECT_GT(checkProjection("ab.exr"), 20);
  // One part with the camera is enough. Without any, the image has no camera.
  removeCamera("b.qfilm");
  for (const auto& order : {std::pair("a.qfilm", "b.qfilm"), std::pair("b.qfilm", "a.qfilm")}) {
    merge({order.first, order.second, "-o", "m.exr"});
    expectSameCamera("m.exr");
  }
  removeCamera("a.qfilm");
  merge({"a.qfilm", "b.qfilm", "-o", "m.exr"});
  EXPECT_FALSE(matrix("m.exr", "worldToNDC"));
  write(folder_ / "b.qfilm", part);
  EXPECT_EQ(render::readFilm(folder_ / "a.qfilm").identity, render::readFilm(folder_ / "b.qfilm").identity);
}

TEST_F(CameraExr, RejectsFilmsWithInvalidMatrices) {
  render("turned.gltf", "a.qfilm");
  const render::FilmFile good = render::readFilm(folder_ / "a.qfilm");
  for (const char* text : {"1 2 3", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 x", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 nan",
                           "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 7"}) {
    render::FilmFile file = good;
    for (auto& [name, value] : file.notes)
      if (name == "world to NDC") value = text;
    render::writeFilm(folder_ / "b.qfilm", file);
    expectError(quintet({"merge", "b.qfilm", "-q", "-o", "m.exr"}), 1, {"b.qfilm: header", "world to NDC"});
    EXPECT_FALSE(std::filesystem::exists(folder_ / "m.exr")) << text;
  }
}

}  // namespace
}  // namespace quintet::test
