// Films that `quintet merge` writes: how their picture is shown is remembered like that of a rendering's film.
#include <optional>

#include "base/file.h"
#include "fixtures.h"
#include "render/film_file.h"

namespace quintet::test {
namespace {

using Arguments = std::vector<std::string>;

class MergeShown : public CliTest {
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

TEST_F(MergeShown, AFilmKeepsExposureAndToneMapForItsPicture) {
  render("whole.png", {"--exposure", "1.5", "--tonemap", "aces"});
  render("plain.png");
  render("like.qfilm", {"--exposure", "1.5", "--tonemap", "aces"});
  render("a.qfilm", {"--batches", "0"});
  render("b.qfilm", {"--batches", "1"});
  merge({"a.qfilm", "b.qfilm"}, "ab.qfilm", {"-q", "--exposure", "1.5", "--tonemap", "aces"});
  for (const char* name : {"exposure", "tone map", "all outputs"})
    EXPECT_EQ(note("ab.qfilm", name), note("like.qfilm", name)) << name;
  merge({"ab.qfilm"}, "ab.png");
  EXPECT_EQ(picture("ab.png").data, picture("whole.png").data);
  EXPECT_NE(picture("ab.png").data, picture("plain.png").data);
  // One of them alone leaves the other; none leaves all.
  merge({"ab.qfilm"}, "other.qfilm", {"-q", "--exposure", "0"});
  EXPECT_EQ(note("other.qfilm", "exposure"), "0");
  EXPECT_EQ(note("other.qfilm", "tone map"), "aces");
  merge({"other.qfilm"}, "other.qfilm", {"-q", "--force", "--tonemap", "linear"});
  merge({"other.qfilm"}, "same.qfilm");
  EXPECT_EQ(note("same.qfilm", "exposure"), "0");
  EXPECT_EQ(note("same.qfilm", "tone map"), "linear");
  // It is no other rendering.
  EXPECT_EQ(render::readFilm(folder_ / "same.qfilm").identity, render::readFilm(folder_ / "like.qfilm").identity);
}

TEST_F(MergeShown, AFilmKeepsThatAllOutputsAreWanted) {
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

TEST_F(MergeShown, TheReportTellsIt) {
  render("a.qfilm", {"--exposure", "2"});
  EXPECT_EQ(nlohmann::json::parse(merge({"a.qfilm"}, "b.qfilm", {"--json"}).out)["exposure"], 2.0);
  EXPECT_EQ(nlohmann::json::parse(merge({"a.qfilm"}, "c.qfilm", {"--json", "--exposure", "-1"}).out)["exposure"], -1.0);
  const std::string unused = "linear radiance, --exposure and --tonemap do not apply";
  EXPECT_NE(merge({"a.qfilm"}, "a.exr", {"--exposure", "1"}).err.find("a.exr: " + unused), std::string::npos);
  for (const char* file : {"a.png", "d.qfilm"})
    EXPECT_EQ(merge({"a.qfilm"}, file, {"--exposure", "1"}).err.find(unused), std::string::npos) << file;
}

}  // namespace
}  // namespace quintet::test
