// SPDX-License-Identifier: Apache-2.0
// Parts join to the film of the whole render; parts that do not belong together are rejected by name.
#include "job/merge.h"

#include <gmock/gmock.h>

#include <limits>

#include "base/error.h"
#include "job/films.h"
#include "temp_folder.h"

namespace quintet::job {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Merge : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const Provenance& p,
                              std::vector<render::SampleRange> ranges) const {
    render::writeFilm(folder_ / name, test::makeFilmFile(p, std::move(ranges)));
    return folder_ / name;
  }
  std::string errorFor(const std::vector<std::filesystem::path>& parts) {
    try {
      merge(parts, observer_);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  const quintet::test::TempFolder folder_;
  Provenance provenance_ = [] {
    Provenance p = test::makeProvenance();
    p.targetError.reset();
    return p;
  }();
  test::RecordingObserver observer_;
};

TEST_F(Merge, JoinsParts) {
  const auto a = write("a.qfilm", provenance_, {{0, 8}}), b = write("b.qfilm", provenance_, {{8, 16}});
  const RenderResult merged = merge({b, a}, observer_);
  EXPECT_EQ(merged.film->counts().ranges, (std::vector<render::SampleRange>{{0, 16}}));
  EXPECT_EQ(merged.provenance.samples, 16u);
  EXPECT_EQ(merged.provenance.rays, 2u * 7 * 12);
  EXPECT_EQ(merged.provenance.droppedSamples, 2u * 12);
  EXPECT_DOUBLE_EQ(merged.provenance.seconds, 2 * provenance_.seconds);
  EXPECT_TRUE(observer_.notes.empty());
  EXPECT_EQ(missingText(merged), "");
}

TEST_F(Merge, ReportsPixelsThatAreNotFinite) {
  const auto a = write("a.qfilm", provenance_, {{0, 8}});
  render::FilmFile film = test::makeFilmFile(provenance_, {{8, 16}});
  film.film.planes[0].sums[4 * 6 + 2] = render::fixedFromFloat(std::numeric_limits<float>::quiet_NaN());
  film.film.statistics[0] = uvec2(7, 0);
  render::writeFilm(folder_ / "b.qfilm", film);
  const RenderResult merged = merge({a, folder_ / "b.qfilm"}, observer_);
  // The film is the region 4x3 at (2, 1).
  EXPECT_THAT(merged.notFinite, testing::ElementsAre(render::NotFinitePixels{"color", 1, {4, 2}}));
  EXPECT_EQ(merged.provenance.notFinitePixels, 1u);
  EXPECT_EQ(merged.provenance.firstDroppedSample, (PixelPosition{2, 1}));
}

TEST_F(Merge, ReportsMissingSamples) {
  EXPECT_EQ(missingText(merge({write("a.qfilm", provenance_, {{4, 8}})}, observer_)), "missing: samples 0–3 and 8–15");
}

TEST_F(Merge, RejectsSharedSamples) {
  const auto a = write("a.qfilm", provenance_, {{0, 8}}), b = write("b.qfilm", provenance_, {{4, 16}});
  EXPECT_THAT(errorFor({a, b}), AllOf(HasSubstr("b.qfilm: shares samples 4–7"), HasSubstr("a.qfilm")));
}

TEST_F(Merge, RejectsDifferentRenders) {
  Provenance other = provenance_;
  other.seed = 3;
  other.size = {9, 6};
  const auto a = write("a.qfilm", provenance_, {{0, 8}}), b = write("b.qfilm", other, {{8, 16}});
  EXPECT_THAT(errorFor({a, b}), AllOf(HasSubstr("b.qfilm"), HasSubstr("a.qfilm"),
                                      HasSubstr("seed 3, expected 4000000000"), HasSubstr("size 9x6, expected 8x6")));
}

TEST_F(Merge, RejectsPartsOfAnAdaptiveRender) {
  provenance_.adaptive = true;
  const auto a = write("a.qfilm", provenance_, {{0, 8}}), b = write("b.qfilm", provenance_, {{8, 16}});
  EXPECT_THAT(errorFor({a, b}), HasSubstr("adaptive"));
  EXPECT_EQ(errorFor({a}), "");
}

TEST_F(Merge, RejectsFilmsWithoutSamples) {
  EXPECT_THAT(errorFor({write("a.qfilm", provenance_, {})}), HasSubstr("no samples"));
}

TEST_F(Merge, JoinsDevices) {
  Provenance other = provenance_;
  other.device = "NVIDIA H200";
  const auto a = write("a.qfilm", provenance_, {{0, 4}}), b = write("b.qfilm", other, {{4, 8}}),
             c = write("c.qfilm", provenance_, {{8, 16}});
  EXPECT_EQ(merge({a, b, c}, observer_).provenance.device, "lavapipe; NVIDIA H200");
  ASSERT_EQ(observer_.notes.size(), 1u);
  EXPECT_THAT(observer_.notes[0], AllOf(HasSubstr("b.qfilm"), HasSubstr("NVIDIA H200")));
}

// Display settings do not depend on the order of the parts on the command line.
TEST_F(Merge, TakesDisplaySettingsOfTheFirstSamples) {
  Provenance other = provenance_;
  other.exposure = 2.0;
  const auto a = write("a.qfilm", provenance_, {{0, 8}}), b = write("b.qfilm", other, {{8, 16}});
  EXPECT_EQ(merge({a, b}, observer_).provenance.exposure, provenance_.exposure);
  EXPECT_EQ(merge({b, a}, observer_).provenance.exposure, provenance_.exposure);
  EXPECT_EQ(observer_.notes.size(), 2u);
}

TEST_F(Merge, JoinsLayers) {
  Provenance first = provenance_, second = provenance_;
  first.layers = R"([{"name":"depth","order":2}])";
  second.layers = R"([{"name":"normal","order":1},{"name":"depth","order":2}])";
  const auto a = write("a.qfilm", first, {{0, 8}}), b = write("b.qfilm", second, {{8, 16}});
  EXPECT_EQ(merge({a, b}, observer_).provenance.layers, R"([{"name":"normal","order":1},{"name":"depth","order":2}])");
}

}  // namespace
}  // namespace quintet::job
