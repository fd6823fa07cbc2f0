// SPDX-License-Identifier: Apache-2.0
// Films that `quintet merge` writes keep the display settings, as the film of a render does.
#include <optional>

#include "base/file.h"
#include "fixtures.h"
#include "render/film/film_file.h"

namespace quintet::test {
namespace {

using Arguments = std::vector<std::string>;

class MergeDisplay : public CliTest {
 protected:
  // 8 samples: 2 batches.
  void render(const std::string& output, const Arguments& more = {}) {
    Arguments arguments = quick({"--spp", "8", "--size", "12x8", "-o", output});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = quintet(arguments);
    ASSERT_EQ(result.status, 0) << result.err;
  }
  RunResult merge(Arguments parts, const std::string& output, const Arguments& more = {"-q"}) {
    parts.insert(parts.begin(), "merge");
    parts.insert(parts.end(), {"-o", output});
    parts.insert(parts.end(), more.begin(), more.end());
    RunResult result = quintet(parts);
    EXPECT_EQ(result.status, 0) << result.err;
    return result;
  }
  std::optional<std::string> note(const std::string& film, const std::string& name) {
    const render::FilmFile file = render::readFilm(folder_ / film);
    const std::string* text = render::findFact(file.notes, name);
    return text ? std::optional(*text) : std::nullopt;
  }
};

TEST_F(MergeDisplay, FilmsKeepExposureAndToneMap) {
  render("whole.png", {"--exposure", "1.5", "--tonemap", "aces"});
  render("plain.png");
  render("expected.qfilm", {"--exposure", "1.5", "--tonemap", "aces"});
  render("a.qfilm", {"--batches", "0"});
  render("b.qfilm", {"--batches", "1"});
  merge({"a.qfilm", "b.qfilm"}, "ab.qfilm", {"-q", "--exposure", "1.5", "--tonemap", "aces"});
  for (const char* name : {"exposure", "tone map", "all outputs"})
    EXPECT_EQ(note("ab.qfilm", name), note("expected.qfilm", name)) << name;
  merge({"ab.qfilm"}, "ab.png");
  EXPECT_EQ(readImage("ab.png").data, readImage("whole.png").data);
  EXPECT_NE(readImage("ab.png").data, readImage("plain.png").data);
  // An option replaces one setting and keeps the other.
  merge({"ab.qfilm"}, "other.qfilm", {"-q", "--exposure", "0"});
  EXPECT_EQ(note("other.qfilm", "exposure"), "0");
  EXPECT_EQ(note("other.qfilm", "tone map"), "aces");
  merge({"other.qfilm"}, "other.qfilm", {"-q", "--force", "--tonemap", "linear"});
  merge({"other.qfilm"}, "same.qfilm");
  EXPECT_EQ(note("same.qfilm", "exposure"), "0");
  EXPECT_EQ(note("same.qfilm", "tone map"), "linear");
  // Display settings do not belong to the identity.
  EXPECT_EQ(render::readFilm(folder_ / "same.qfilm").identity, render::readFilm(folder_ / "expected.qfilm").identity);
}

TEST_F(MergeDisplay, FilmsKeepTheRequestForAllOutputs) {
  render("a.qfilm");
  EXPECT_EQ(note("a.qfilm", "all outputs"), "no");
  merge({"a.qfilm"}, "b.qfilm", {"-q", "--all-outputs"});
  EXPECT_EQ(note("b.qfilm", "all outputs"), "yes");
  merge({"a.qfilm"}, "a.png");
  merge({"b.qfilm"}, "b.png");
  const Arguments names = fileNames();
  const auto has = [&](const char* name) { return std::ranges::find(names, name) != names.end(); };
  EXPECT_TRUE(has("a.png"));
  EXPECT_FALSE(has("b.png"));
  EXPECT_TRUE(has("b.color.png"));
}

TEST_F(MergeDisplay, JsonAndNotesReportExposure) {
  render("a.qfilm", {"--exposure", "2"});
  EXPECT_EQ(nlohmann::json::parse(merge({"a.qfilm"}, "b.qfilm", {"--json"}).out)["exposure"], 2.0);
  EXPECT_EQ(nlohmann::json::parse(merge({"a.qfilm"}, "c.qfilm", {"--json", "--exposure", "-1"}).out)["exposure"], -1.0);
  // The note names the file, and precedes the summary, which names it again.
  const auto notes = [&](const std::string& file, const Arguments& more) {
    const std::string text = merge({"a.qfilm"}, file, more).err;
    return text.find(file + ": ") != text.rfind(file + ": ") && text.find("exposure") != std::string::npos;
  };
  EXPECT_TRUE(notes("a.exr", {"--exposure", "1"}));
  EXPECT_FALSE(notes("b.exr", {})) << "the exposure of the render was not requested for this file";
  for (const char* file : {"a.png", "d.qfilm"}) EXPECT_FALSE(notes(file, {"--exposure", "1"})) << file;
}

}  // namespace
}  // namespace quintet::test
