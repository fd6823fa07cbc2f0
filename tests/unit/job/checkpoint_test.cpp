// SPDX-License-Identifier: Apache-2.0
// A checkpoint continues exactly its own render; everything else is an error that names the file.
#include "job/checkpoint.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "base/file.h"
#include "job/films.h"
#include "temp_folder.h"

namespace quintet::job {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class CheckpointLoad : public testing::Test {
 protected:
  void write(const Provenance& p, std::vector<render::SampleRange> ranges) const {
    render::writeFilm(file_, test::makeFilmFile(p, std::move(ranges)));
  }
  std::optional<StoredFilm> load(CheckpointRequest request, const StartPoint& start = {}, std::uint64_t samples = 16) {
    request.file = file_;
    request.waitSeconds = 0;
    RenderLimits limits;
    limits.samples = samples;
    return Checkpoint(request, observer_).load(provenance_, test::makeFilm(provenance_, {}), start, limits, observer_);
  }
  std::string errorFor(const CheckpointRequest& request, const StartPoint& start = {}, std::uint64_t samples = 16) {
    try {
      load(request, start, samples);
    } catch (const FileError& error) {
      remedy_ = error.remedy();
      return error.what();
    }
    return "";
  }

  const quintet::test::TempFolder folder_;
  const std::filesystem::path file_ = folder_ / "scene.qfilm";
  Provenance provenance_ = test::makeProvenance();
  test::RecordingObserver observer_;
  Remedy remedy_ = Remedy::none;  // of the last error
};

TEST_F(CheckpointLoad, ResumesTheSameRender) {
  write(provenance_, {{0, 8}});
  const auto film = load({.resume = true});
  ASSERT_TRUE(film);
  EXPECT_EQ(film->file.film.counts.ranges, (std::vector<render::SampleRange>{{0, 8}}));
  EXPECT_TRUE(observer_.notes.empty());
}

TEST_F(CheckpointLoad, StartsWithoutAFile) {
  EXPECT_FALSE(load({}));
  EXPECT_TRUE(observer_.notes.empty());
  EXPECT_FALSE(load({.resume = true}));
  ASSERT_EQ(observer_.notes.size(), 1u);
  EXPECT_THAT(observer_.notes[0], HasSubstr("scene.qfilm"));
}

TEST_F(CheckpointLoad, KeepsAnExistingCheckpointUnlessForced) {
  write(provenance_, {{0, 8}});
  EXPECT_THAT(errorFor({}), HasSubstr("8 samples"));
  EXPECT_EQ(remedy_, Remedy::resumeOrStartOver);
  EXPECT_FALSE(load({.force = true}));
  EXPECT_TRUE(load({.resume = true, .force = true})) << "force does not discard a checkpoint of this render";
}

TEST_F(CheckpointLoad, RejectsADifferentRender) {
  Provenance other = provenance_;
  other.seed = 3;
  write(other, {{0, 8}});
  EXPECT_THAT(errorFor({.resume = true}),
              HasSubstr("scene.qfilm: belongs to a different render (seed 3, expected 4000000000)"));
  EXPECT_EQ(remedy_, Remedy::startOver);
  EXPECT_FALSE(load({.resume = true, .force = true}));
}

TEST_F(CheckpointLoad, RejectsSamplesOutsideOfThisPart) {
  write(provenance_, {{0, 8}});
  EXPECT_THAT(errorFor({.resume = true}, {.begin = 8, .done = 8}), HasSubstr("starts at sample 8"));
  EXPECT_THAT(errorFor({.resume = true}, {}, 4), HasSubstr("ends at sample 3"));
  EXPECT_EQ(errorFor({.resume = true}, {}, 8), "");
}

TEST_F(CheckpointLoad, RejectsDamage) {
  write(provenance_, {{0, 8}});
  std::vector<std::byte> bytes = readFile(file_);
  bytes.resize(bytes.size() - 1);
  writeFile(file_, bytes);
  EXPECT_THAT(errorFor({.resume = true}), HasSubstr("scene.qfilm"));
  EXPECT_FALSE(load({.resume = true, .force = true}));
}

TEST_F(CheckpointLoad, RejectsDifferentArrays) {
  render::FilmFile film = test::makeFilmFile(provenance_, {{0, 8}});
  film.film.planes[0].name = "other";
  render::writeFilm(file_, film);
  EXPECT_THAT(errorFor({.resume = true}), HasSubstr("outputs"));
  EXPECT_EQ(remedy_, Remedy::startOver);
}

// Whatever makes a checkpoint unusable, the error says how to start over, and --force does it.
TEST_F(CheckpointLoad, NamesTheRemedyForDamagedFiles) {
  write(provenance_, {{0, 8}});
  const std::vector<std::byte> whole = readFile(file_);
  const auto truncated = [&](std::size_t size) {
    return std::vector(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
  };
  std::vector<std::byte> flipped = whole;
  flipped[whole.size() / 2] ^= std::byte{1};
  for (const std::vector<std::byte>& bytes :
       {truncated(0), truncated(3), truncated(100), truncated(whole.size() - 1), flipped}) {
    writeFile(file_, std::span(bytes));
    EXPECT_THAT(errorFor({.resume = true}), HasSubstr("scene.qfilm: ")) << bytes.size();
    EXPECT_EQ(remedy_, Remedy::startOver) << bytes.size();
    EXPECT_FALSE(load({.resume = true, .force = true})) << bytes.size();
    EXPECT_THAT(observer_.notes.back(), HasSubstr("; starting over")) << bytes.size();
  }
  write(provenance_, {{4, 8}});
  EXPECT_THAT(errorFor({.resume = true}), HasSubstr("starts at sample 0"));
  EXPECT_EQ(remedy_, Remedy::startOver);
}

RenderResult resultOf(const Provenance& p, std::vector<render::SampleRange> ranges) {
  RenderResult result;
  result.provenance = p;
  result.film = viewOf(test::makeFilm(p, std::move(ranges)), false);
  result.provenance.samples = result.film->counts().samples();
  return result;
}

TEST_F(CheckpointLoad, SavesAndRemoves) {
  const RenderResult result = resultOf(provenance_, {{0, 12}});
  {
    Checkpoint checkpoint({.file = file_, .seconds = 0}, observer_);
    EXPECT_TRUE(checkpoint.isDue());
    checkpoint.save(result, observer_);
    EXPECT_EQ(checkpoint.savedSamples(), 12u);
  }
  EXPECT_EQ(folder_.entryCount(), 1u);
  const auto film = load({.resume = true});
  ASSERT_TRUE(film);
  EXPECT_TRUE(test::equalSums(film->file.film.planes[0].sums, result.film->plane(0).sums));
  Checkpoint({.file = file_}, observer_).remove(observer_);
  EXPECT_EQ(folder_.entryCount(), 0u);
  EXPECT_TRUE(observer_.warnings.empty());
}

TEST_F(CheckpointLoad, BelongsToOneProcessAtATime) {
  Checkpoint checkpoint({.file = file_, .seconds = 0}, observer_);
  EXPECT_THAT(errorFor({.resume = true}), HasSubstr("scene.qfilm: is in use by process "));
  checkpoint.save(resultOf(provenance_, {{0, 8}}), observer_);  // replaces the file
  EXPECT_THAT(errorFor({.resume = true, .force = true}), HasSubstr("is in use"));
}

TEST_F(CheckpointLoad, AFailureToSaveIsOneWarning) {
  struct FullDisk : test::RecordingObserver {
    void write(const std::filesystem::path& file, std::span<const std::byte>) override {
      throw FileError(file, "no space left on device");
    }
  } observer;
  Checkpoint checkpoint({.file = file_}, observer);
  checkpoint.save(resultOf(provenance_, {{0, 4}}), observer);
  checkpoint.save(resultOf(provenance_, {{0, 8}}), observer);
  ASSERT_EQ(observer.warnings.size(), 1u);
  EXPECT_THAT(observer.warnings[0], AllOf(HasSubstr("scene.qfilm"), HasSubstr("no space left")));
  EXPECT_EQ(checkpoint.savedSamples(), 0u);
}

TEST_F(CheckpointLoad, StaysIfTheRenderIsIncomplete) {
  RenderResult result = resultOf(provenance_, {{0, 4}});
  EXPECT_FALSE(Checkpoint({.file = file_}, observer_).mustStay(result));
  EXPECT_TRUE(Checkpoint({.file = file_, .keep = true}, observer_).mustStay(result));
  result.interrupted = true;
  EXPECT_TRUE(Checkpoint({.file = file_}, observer_).mustStay(result));
  result.interrupted = false;
  result.targetMissed = true;
  EXPECT_TRUE(Checkpoint({.file = file_}, observer_).mustStay(result));
}

TEST_F(CheckpointLoad, ResumePoint) {
  const StoredFilm film{test::makeFilmFile(provenance_, {{4, 12}}), provenance_};
  const StartPoint start{.begin = 4, .done = 4};
  const StartPoint point = resumePoint(film, provenance_, file_, start, observer_);
  EXPECT_EQ(point.begin, 4u);
  EXPECT_EQ(point.done, 12u);
  EXPECT_EQ(point.seconds, provenance_.seconds);
  ASSERT_EQ(observer_.notes.size(), 1u);
  EXPECT_THAT(observer_.notes[0], HasSubstr("resuming after 8 samples"));
  Provenance current = provenance_;
  current.device = "NVIDIA H200";
  observer_.notes.clear();
  resumePoint(film, current, file_, start, observer_);
  ASSERT_EQ(observer_.notes.size(), 2u);
  EXPECT_THAT(observer_.notes[0], HasSubstr("started on lavapipe, resuming on NVIDIA H200"));
}

// A plan of adaptive sampling holds for one target error.
TEST_F(CheckpointLoad, ResumePointDropsThePlanOfADifferentTarget) {
  Provenance current = provenance_;
  current.adaptive = true;
  StoredFilm film{test::makeFilmFile(current, {{0, 16}}), current};
  film.file.plan = {7, 9};
  EXPECT_EQ(resumePoint(film, current, file_, {}, observer_).plan, film.file.plan);
  film.provenance.targetError = 0.5;
  observer_.notes.clear();
  EXPECT_TRUE(resumePoint(film, current, file_, {}, observer_).plan.empty());
  ASSERT_EQ(observer_.notes.size(), 2u);
  EXPECT_THAT(observer_.notes[0], AllOf(HasSubstr("50 %"), HasSubstr("2 %")));
}

}  // namespace
}  // namespace quintet::job
