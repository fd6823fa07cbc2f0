// SPDX-License-Identifier: Apache-2.0
// Film files are never overwritten by a film that lacks their samples, unless the user insists.
#include "job/film_store.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "base/file.h"
#include "job/films.h"
#include "temp_folder.h"

namespace quintet::job {
namespace {

using render::SampleCounts;
using render::SampleRange;
using testing::AllOf;
using testing::HasSubstr;
using Role = ProvenanceField::Role;

class RejectLoss : public testing::Test {
 protected:
  std::string errorFor(const Provenance& p, const SampleCounts& counts) const {
    try {
      rejectLoss(file_, toFacts(p, Role::identity), counts);
    } catch (const FileError& error) {
      EXPECT_EQ(error.remedy(), Remedy::overwrite);
      return error.what();
    }
    return "";
  }

  const quintet::test::TempFolder folder_;
  const std::filesystem::path file_ = folder_ / "part.qfilm";
  const Provenance provenance_ = test::makeProvenance();
};

TEST_F(RejectLoss, NothingIsLostWithoutAFile) { EXPECT_EQ(errorFor(provenance_, {}), ""); }

TEST_F(RejectLoss, SamplesOfTheSameRender) {
  render::writeFilm(file_, test::makeFilmFile(provenance_, {{0, 8}}));
  EXPECT_EQ(errorFor(provenance_, {{{0, 8}}, {}}), "");
  EXPECT_EQ(errorFor(provenance_, {{{0, 16}}, {}}), "");
  EXPECT_THAT(errorFor(provenance_, {{{0, 4}}, {}}), AllOf(HasSubstr("part.qfilm"), HasSubstr("0–7")));
  EXPECT_THAT(errorFor(provenance_, {{{8, 16}}, {}}), HasSubstr("0–7"));
}

TEST_F(RejectLoss, ADifferentRender) {
  render::writeFilm(file_, test::makeFilmFile(provenance_, {{0, 8}}));
  Provenance other = provenance_;
  other.seed = 3;
  EXPECT_THAT(errorFor(other, {{{0, 8}}, {}}),
              AllOf(HasSubstr("seed 4000000000, expected 3"), HasSubstr("lost"), testing::Not(HasSubstr("size"))));
  other = provenance_;
  other.device = "another device";
  EXPECT_EQ(errorFor(other, {{{0, 8}}, {}}), "") << "notes are not part of the identity";
}

TEST_F(RejectLoss, AdaptiveSamples) {
  Provenance p = provenance_;
  p.adaptive = true;
  render::FilmFile film = test::makeFilmFile(p, {{0, 16}});
  film.film.counts.cellBatches = {5, 4};
  render::writeFilm(file_, film);
  EXPECT_EQ(errorFor(p, {{{0, 16}}, {5, 6}}), "");
  EXPECT_THAT(errorFor(p, {{{0, 16}}, {4, 9}}), HasSubstr("on average"));
  EXPECT_THAT(errorFor(p, {{{0, 16}}, {}}), HasSubstr("on average")) << "counts that are not known yet";
}

TEST_F(RejectLoss, ADamagedFilm) {
  std::vector<std::byte> bytes = render::encodeFilm(test::makeFilmFile(provenance_, {{0, 8}}));
  bytes[bytes.size() / 2] ^= std::byte{1};
  writeFile(file_, bytes);
  EXPECT_THAT(errorFor(provenance_, {{{0, 8}}, {}}), HasSubstr("part.qfilm"));
}

TEST(FilmTexts, Samples) {
  EXPECT_EQ(rangesText({}), "no samples");
  EXPECT_EQ(rangesText({{32, 33}}), "sample 32");
  EXPECT_EQ(rangesText({{0, 16}, {32, 33}}), "samples 0–15 and 32");
  render::FilmState film;
  film.region = {0, 0, 32, 32};
  film.counts.ranges = {{0, 16}};
  EXPECT_EQ(samplesText(film), "samples 0–15");
  film.counts.cellBatches = {4, 6};
  EXPECT_EQ(samplesText(film), "20.0 samples per pixel on average (16–24)");
}

}  // namespace
}  // namespace quintet::job
