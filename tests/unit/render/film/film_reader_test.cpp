// SPDX-License-Identifier: Apache-2.0
// Films that are read as streams: the sum of films is that of whole films in memory, and all damage is detected.
#include "render/film/film_reader.h"

#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <random>

#include "base/error.h"
#include "base/file.h"
#include "render/film/film_file.h"
#include "render/film/fixed_sum.h"
#include "temp_folder.h"

namespace quintet::render {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// The part of a render with these samples. The arrays have several blocks, and the last ones are shorter.
FilmFile partOf(SampleRange range, std::uint32_t width = 211, std::uint32_t height = 157) {
  std::mt19937 random(range.begin + 1);
  std::uniform_real_distribution<float> value(-2.0f, 50.0f);
  FilmFile file;
  file.identity = {{"seed", "3"}};
  file.notes = {{"device", "lavapipe"}};
  FilmState& film = file.film;
  film.region = {1, 2, width, height};
  film.counts.ranges = {range};
  const std::size_t pixels = film.pixelCount();
  const auto number = [&](std::uint32_t largest) { return 1 + static_cast<std::uint32_t>(random() % largest); };
  const auto sums = [&] {
    std::vector<shared::FixedSum> values(4 * pixels);
    for (shared::FixedSum& sum : values) sum = fixedFromFloat(value(random));
    values[random() % values.size()] = fixedFromFloat(std::numeric_limits<float>::quiet_NaN());
    return values;
  };
  using program::OutputKind, program::OutputPixel;
  film.planes.resize(4);
  film.planes[0] = {.name = "color", .sums = sums(), .squares = sums()};
  film.planes[1] = {.name = "unwanted"};
  film.planes[2] = {.name = "depth", .pixel = OutputPixel::center, .kind = OutputKind::depth, .color = false};
  for (std::size_t i = 0; i < pixels; ++i) film.planes[2].values.emplace_back(value(random));
  film.planes[3] = {.name = "ids", .pixel = OutputPixel::coverage, .kind = OutputKind::id, .color = false};
  for (std::size_t i = 0; i < pixels;
       ++i) {  // sorted ids, then empty slots; more ids in all parts than there are slots
    std::uint32_t id = 0;
    const std::size_t used = random() % (shared::kCoverageSlots + 1);
    for (std::size_t s = 0; s < shared::kCoverageSlots; ++s)
      film.planes[3].coverage.push_back(s < used ? shared::CoverageSlot{id += number(3), number(4)}
                                                 : shared::CoverageSlot{0, 0});
    film.statistics.emplace_back(random() % 1000, random() % 2);
  }
  return file;
}

class FilmReaderTest : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const FilmFile& file) const {
    writeFilm(folder_ / name, file);
    return folder_ / name;
  }
  static std::string errorOf(const std::function<void()>& call) {
    try {
      call();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  // What each way to read the file reports.
  std::vector<std::string> errorsFor(const std::vector<std::byte>& bytes) const {
    const std::filesystem::path path = folder_ / "bad.qfilm";
    writeFile(path, bytes);
    FilmFile sum = partOf({0, 8});
    return {errorOf([&] { FilmReader(path).read(); }), errorOf([&] { FilmReader(path).addTo(sum.film); }),
            errorOf([&] { FilmReader(path).verify(); })};
  }

  const quintet::test::TempFolder folder_;
};

TEST_F(FilmReaderTest, ReadsWhatWasWritten) {
  const auto path = write("a.qfilm", partOf({0, 8}));
  EXPECT_EQ(encodeFilm(FilmReader(path).read()), readFile(path));
  EXPECT_EQ(FilmReader(path).fileBytes(), std::filesystem::file_size(path));
  const FilmReader reader(path);
  EXPECT_EQ(reader.header().film.counts.ranges, (std::vector<SampleRange>{{0, 8}}));
  EXPECT_TRUE(reader.header().film.planes[0].sums.empty());
}

// The oracle: all films in memory, merged by mergeFilm().
TEST_F(FilmReaderTest, AddsFilmsAsMergeFilmDoes) {
  const std::vector<FilmFile> parts{partOf({8, 16}), partOf({16, 20}), partOf({0, 8}), partOf({20, 30})};
  FilmFile expected = parts[0], sum = parts[0];
  for (std::size_t i = 1; i < parts.size(); ++i) {
    mergeFilm(expected.film, parts[i].film);
    FilmReader reader(write("part.qfilm", parts[i]));
    ASSERT_TRUE(reader.hasArraysOf(sum.film));
    reader.addTo(sum.film);
    ASSERT_EQ(encodeFilm(sum), encodeFilm(expected)) << i;
  }
  EXPECT_EQ(sum.film.counts.ranges, (std::vector<SampleRange>{{0, 30}}));
}

TEST_F(FilmReaderTest, AdaptiveFilmsKeepTheirCellsAndAreNotAdded) {
  FilmFile file = partOf({0, 8});
  for (std::uint32_t c = 0; c < 2 * tileCount(file.film.region); ++c) {
    file.film.counts.cellBatches.push_back(2 + c % 3);
    file.plan.push_back(c);
  }
  const auto path = write("a.qfilm", file);
  EXPECT_EQ(encodeFilm(FilmReader(path).read()), readFile(path));
  FilmFile sum = partOf({8, 16});
  EXPECT_THAT(errorOf([&] { FilmReader(path).addTo(sum.film); }), HasSubstr("adaptive"));
}

TEST_F(FilmReaderTest, DoesNotAddTheSameSamplesTwice) {
  const auto path = write("a.qfilm", partOf({0, 8}));
  FilmFile sum = partOf({4, 16});
  EXPECT_THAT(errorOf([&] { FilmReader(path).addTo(sum.film); }), HasSubstr("samples 4–7"));
}

TEST_F(FilmReaderTest, ComparesArrays) {
  const FilmFile file = partOf({0, 8}, 8, 8);
  const FilmReader reader(write("a.qfilm", file));
  EXPECT_TRUE(reader.hasArraysOf(file.film));
  FilmFile other = file;
  other.film.planes[0].squares.clear();
  EXPECT_FALSE(reader.hasArraysOf(other.film));
  other = file;
  other.film.planes[3].name = "objects";
  EXPECT_FALSE(reader.hasArraysOf(other.film));
  EXPECT_FALSE(reader.hasArraysOf(partOf({0, 8}, 8, 9).film));
}

TEST_F(FilmReaderTest, DetectsAllDamage) {
  const std::vector<std::byte> good = readFile(write("a.qfilm", partOf({8, 16})));
  for (const std::string& error : errorsFor(good)) EXPECT_EQ(error, "");
  std::mt19937 random(5);
  std::vector<std::size_t> positions{0, 9, 12, 20, 30, 300, good.size() - 1, good.size() - 17};
  for (int i = 0; i < 30; ++i) positions.push_back(random() % good.size());
  for (const std::size_t at : positions) {
    std::vector<std::byte> bad = good;
    bad[at] ^= std::byte{0x10};
    for (const std::string& error : errorsFor(bad))
      EXPECT_THAT(error, testing::AnyOf(HasSubstr("damaged"), HasSubstr("truncated"), HasSubstr("not a film"),
                                        HasSubstr("version")))
          << at;
  }
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, std::size_t{23}, std::size_t{900}, good.size() - 1}) {
    for (const std::string& error : errorsFor({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}))
      EXPECT_THAT(error, HasSubstr(size == 0 ? "empty" : "truncated")) << size;
  }
  std::vector<std::byte> longer = good;
  longer.push_back(std::byte{0});
  for (const std::string& error : errorsFor(longer)) EXPECT_THAT(error, HasSubstr("1 excess byte"));
}

// A valid checksum proves nothing about a file that was made on purpose.
TEST_F(FilmReaderTest, RejectsBlocksThatDoNotMatchTheHeader) {
  FilmFile file = partOf({8, 16}, 16, 16);
  file.film.statistics.pop_back();
  const auto path = write("a.qfilm", file);
  FilmFile sum = partOf({0, 8}, 16, 16);
  EXPECT_THAT(errorOf([&] { FilmReader(path).read(); }), AllOf(HasSubstr("a.qfilm: payload"), HasSubstr("blocks")));
  EXPECT_THAT(errorOf([&] { FilmReader(path).addTo(sum.film); }), HasSubstr("a.qfilm: payload"));
}

TEST_F(FilmReaderTest, LimitsMemory) {
  const auto path = write("a.qfilm", partOf({0, 8}));
  EXPECT_THAT(errorOf([&] { FilmReader(path).read(std::size_t{1} << 20); }), HasSubstr("a.qfilm"));
  EXPECT_EQ(errorOf([&] { FilmReader(path).read(std::size_t{1} << 30); }), "");
}

TEST_F(FilmReaderTest, MissingFilesAndFolders) {
  EXPECT_THAT(errorOf([&] { FilmReader reader(folder_ / "none.qfilm"); }), HasSubstr("No such file"));
  EXPECT_THAT(errorOf([&] { FilmReader reader(folder_.path()); }), HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace quintet::render
