// SPDX-License-Identifier: Apache-2.0
// `compare --z-test`: accepts two renders of the same scene, rejects different images, and reports films that cannot be tested.
#include <sys/wait.h>

#include <cstdlib>

#include <gmock/gmock.h>

#include "base/file.h"
#include "demo/test_scenes.h"
#include "fixtures.h"
#include "render/film/film_file.h"
#include "render/film/fixed_sum.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class CompareFilms : public CliTest {
 protected:
  // Renders scene.gltf, 32x24 pixels.
  void film(const std::string& name, std::vector<std::string> more) {
    more.insert(more.end(), {"-o", name});
    const RunResult result = quintet(quick(more));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  void cornell(const std::string& name, const std::vector<std::string>& more) {
    writeFile(folder_ / "cornell.glb", demo::testScenes()[0].make());
    std::vector<std::string> arguments{"render", "cornell.glb", "-q", "--size", "40x32", "-o", name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = quintet(arguments);
    ASSERT_EQ(result.status, 0) << result.err;
  }
  RunResult compare(const std::string& a, const std::string& b, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"compare", a, b, "--z-test"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quintet(arguments);
  }
  // Writes the film of a renderer that is too bright by this factor.
  void scale(const std::string& from, const std::string& to, double factor) {
    render::FilmFile file = render::readFilm(folder_ / from);
    render::FilmPlane& plane = file.film.planes[0];
    const auto scaled = [](shared::FixedSum& sum, double by) {
      sum = render::fixedFromFloat(static_cast<float>(render::fixedToDouble(sum) * by));
    };
    for (shared::FixedSum& sum : plane.sums) scaled(sum, factor);
    for (shared::FixedSum& square : plane.squares) scaled(square, factor * factor);
    render::writeFilm(folder_ / to, file);
  }
};

TEST_F(CompareFilms, AcceptsDifferentSeedsAndRejectsABrighterImage) {
  cornell("a.qfilm", {"--spp", "32", "--seed", "1"});
  cornell("b.qfilm", {"--spp", "32", "--seed", "2"});
  const RunResult same = compare("a.qfilm", "b.qfilm");
  EXPECT_EQ(same.status, 0) << same.out << same.err;
  EXPECT_EQ(same.err, "");
  EXPECT_THAT(same.out, HasSubstr("a.qfilm: samples 0–31, seed 1, "));
  EXPECT_THAT(same.out, ContainsRegex("20 of 8x8 pixels, 3 channels.*8\\.35e-05"));  // 1 - 0.995^(1/60)
  EXPECT_THAT(same.out, EndsWith("the same image at level 0.01\n"));
  const auto json = nlohmann::json::parse(compare("a.qfilm", "b.qfilm", {"--json", "-o", "t.png"}).out);
  EXPECT_EQ(json["same"], true);
  EXPECT_EQ(json["tests"], 60);
  EXPECT_EQ(json["seeds"], (nlohmann::json{"1", "2"}));
  EXPECT_EQ(json["batches"], (nlohmann::json{8, 8}));
  EXPECT_EQ(json["devices"][0], json["devices"][1]);
  EXPECT_EQ(json["image"].size(), 3u);
  EXPECT_EQ(json["notes"].size(), 0u);
  EXPECT_EQ(json["distribution"]["noisyTests"], 60);
  EXPECT_EQ(readImage("t.png").width, 40u);

  scale("b.qfilm", "c.qfilm", 1.05);
  const RunResult bright = compare("a.qfilm", "c.qfilm");
  EXPECT_EQ(bright.status, 1);
  EXPECT_THAT(bright.out, EndsWith("different images at level 0.01\n"));
  EXPECT_THAT(bright.err, ContainsRegex("quintet: a\\.qfilm and c\\.qfilm: .* 0\\.01: the whole image, "));
  EXPECT_EQ(nlohmann::json::parse(compare("a.qfilm", "c.qfilm", {"--json"}).out)["same"], false);

  scale("b.qfilm", "d.qfilm", 1.0);
  EXPECT_EQ(compare("a.qfilm", "d.qfilm").status, 0);

  // Different samples of one seed are independent. The same samples are not.
  cornell("e.qfilm", {"--spp", "64", "--seed", "1", "--batches", "8-15"});
  EXPECT_EQ(compare("e.qfilm", "b.qfilm").status, 0);
  const RunResult twice = compare("a.qfilm", "a.qfilm");
  EXPECT_EQ(twice.status, 0);
  EXPECT_THAT(twice.out, AllOf(HasSubstr("note: "), HasSubstr("seed 1")));
  EXPECT_EQ(compare("a.qfilm", "e.qfilm").out.find("note"), std::string::npos);
}

TEST_F(CompareFilms, RejectsDifferentRendersByFact) {
  film("a.qfilm", {"--spp", "32"});
  write(folder_ / "other.gltf", [] {
    nlohmann::json scene = quadScene();
    scene["nodes"][0]["name"] = "another";
    scene["materials"] = nlohmann::json::array({{{"pbrMetallicRoughness", {{"roughnessFactor", 0.25}}}}});
    scene["meshes"][0]["primitives"][0]["material"] = 0;
    return scene.dump();
  }());
  const RunResult other = quintet(
      {"render", "other.gltf", "--program", "normals", "-q", "--size", "32x24", "--spp", "32", "-o", "b.qfilm"});
  ASSERT_EQ(other.status, 0) << other.err;
  const RunResult scene = compare("a.qfilm", "b.qfilm");
  EXPECT_EQ(scene.status, 1);
  EXPECT_EQ(scene.out, "");
  EXPECT_THAT(
      scene.err,
      ContainsRegex("quintet: b\\.qfilm: .*a\\.qfilm.*scene [0-9a-f]{12}, expected [0-9a-f]{12}.*--may-differ"));
  EXPECT_EQ(compare("a.qfilm", "b.qfilm", {"--may-differ", "scene"}).status, 0);
  EXPECT_EQ(quintet({"compare", "--z-test", "--may-differ", "scene", "a.qfilm", "b.qfilm"}).status, 0);

  film("c.qfilm", {"--spp", "32", "--size", "32x25"});
  EXPECT_THAT(compare("a.qfilm", "c.qfilm").err, HasSubstr("size 32x25, expected 32x24"));
  expectError(compare("a.qfilm", "c.qfilm", {"--may-differ", "size", "--may-differ", "region"}), 1,
              {"a.qfilm and c.qfilm: ", "region"});
  film("d.qfilm", {"--spp", "64", "--seed", "4"});
  const RunResult longer = compare("a.qfilm", "d.qfilm");
  EXPECT_EQ(longer.status, 0) << longer.err;
  EXPECT_THAT(longer.out, AllOf(HasSubstr("note: "), HasSubstr("numbers of samples")));
}

// tests/devices/run parses the output of --json with sed and awk.
TEST_F(CompareFilms, TableOfTwoDevices) {
  std::filesystem::create_directory(folder_ / "a");
  std::filesystem::create_directory(folder_ / "b");
  for (const char* name : {"/cornell.qfilm", "/glass.qfilm", "/demo.qfilm"})
    film(std::string("a") + name, {"--spp", "32", "--seed", "1"});
  film("b/cornell.qfilm", {"--spp", "32", "--seed", "2"});
  film("b/glass.qfilm", {"--spp", "32", "--seed", "3"});
  scale("b/glass.qfilm", "b/glass.qfilm", 0.5);
  film("b/demo.qfilm", {"--spp", "32", "--size", "32x25"});
  const std::string folder = folder_.path().string();
  const std::string command = "QUINTET='" QUINTET_BINARY "' '" QUINTET_SOURCE_ROOT "/tests/devices/run' '" + folder +
                              "/a' '" + folder + "/b' >'" + folder + "/table' 2>'" + folder + "/errors'";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 1);
  const std::string table = readTextFile(folder_ / "table");
  EXPECT_THAT(
      table,
      ContainsRegex(
          R"(\| cornell \| 32 \| 12 \| [0-9.e-]+ \([0-9.e-]+\) \| [0-9.]+ \| [0-9.e-]+ \([0-9.e-]+\) \| [-+][0-9.]+ % ± [0-9.]+ % \| same \|)"));
  EXPECT_THAT(table, ContainsRegex(R"(\| glass .* \+66.[0-9]+ % ± .* \*\*rejected\*\* \|)"));
  EXPECT_THAT(table, HasSubstr("| demo | | | | | | | not compared |"));
  EXPECT_THAT(table,
              HasSubstr("Level 0.00334 for each of 3 scenes; seeds \"1\", \"3\"; devices \""));  // 1 - 0.99^(1/3)
  EXPECT_THAT(readTextFile(folder_ / "errors"), HasSubstr("size 32x25, expected 32x24"));
}

TEST_F(CompareFilms, FilmsThatCannotBeTested) {
  film("a.qfilm", {"--spp", "32"});
  film("few.qfilm", {"--spp", "28"});
  ASSERT_EQ(quintet(quick({"-o", "p.png"})).status, 0);
  expectError(compare("a.qfilm", "few.qfilm"), 1, {"a.qfilm and few.qfilm: ", "7 batches", "32 samples"});
  expectError(compare("a.qfilm", "p.png"), 1, {"p.png: ", "film", ".qfilm"});
  expectError(compare("a.qfilm", "none.qfilm"), 1, {"none.qfilm", "No such file"});
  expectError(quintet({"compare", "a.qfilm", "a.qfilm"}), 1, {"a.qfilm: ", "film", "--z-test"});
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong{
      {{"--level", "0"}, "--level"},
      {{"--level", "0.9"}, "--level"},
      {{"--block", "2"}, "--block"},
      {{"--block", "8.5"}, "--block: '8.5'"},
      {{"--tolerance", "-1"}, "--tolerance"},
      {{"--may-differ", "sceen"}, "'sceen' (did you mean 'scene'?)"},
      {{"--max", "3"}, "--max: "},
      {{"--resize"}, "--resize: "}};
  for (const auto& [more, text] : wrong) expectError(compare("a.qfilm", "a.qfilm", more), 2, {text});
  expectError(quintet({"compare", "p.png", "p.png", "--level", "0.1"}), 2, {"--level: ", "--z-test"});
}

}  // namespace
}  // namespace quintet::test
