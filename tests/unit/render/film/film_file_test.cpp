// SPDX-License-Identifier: Apache-2.0
// Film files: contents are read back word for word, and all damage is detected and named.
#include "render/film/film_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "render/film/fixed_sum.h"
#include "temp_folder.h"

namespace quintet::render {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::size_t kPrefixBytes = 24;
constexpr std::size_t kHashBytes = 16;

// A film with all kinds of planes and values: positive, small, negative, and not finite.
FilmFile sample(std::uint32_t width = 37, std::uint32_t height = 21, bool cells = false) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal(0.5f, 1.0f);
  FilmFile file;
  file.identity = {{"scene", "9f\"\\ ü"}, {"seed", "3"}, {"empty", ""}};
  file.notes = {{"device", "lavapipe"}};
  FilmState& film = file.film;
  film.region = {5, 6, width, height};
  film.counts.ranges = {{0, 16}, {32, 37}};
  if (cells) {  // in the middle of a plan
    film.counts.ranges.pop_back();
    for (std::uint32_t c = 0; c < 2 * tileCount(film.region); ++c) {
      film.counts.cellBatches.push_back(4 + static_cast<std::uint32_t>(random() % 9));
      file.plan.push_back(static_cast<std::uint32_t>(random() % 30));
    }
  }
  const std::size_t pixels = film.pixelCount();
  const auto sums = [&] {
    std::vector<shared::FixedSum> values(4 * pixels);
    for (shared::FixedSum& value : values) value = fixedFromFloat(normal(random));
    values[1] = fixedFromFloat(std::numeric_limits<float>::infinity());
    return values;
  };
  using program::OutputKind, program::OutputPixel;
  film.planes.resize(4);
  film.planes[0] = {.name = "color", .sums = sums(), .squares = sums()};
  film.planes[1] = {.name = "unwanted", .kind = OutputKind::display};
  film.planes[2] = {.name = "depth",
                    .pixel = OutputPixel::center,
                    .kind = OutputKind::depth,
                    .color = false,
                    .values = std::vector<vec4>(pixels, vec4(1.5f, -2, 0, 1))};
  film.planes[3] = {.name = "ids",
                    .pixel = OutputPixel::coverage,
                    .kind = OutputKind::id,
                    .color = false,
                    .coverage = std::vector<shared::CoverageSlot>(shared::kCoverageSlots * pixels)};
  for (shared::CoverageSlot& slot : film.planes[3].coverage)
    slot = {static_cast<std::uint32_t>(random()), static_cast<std::uint32_t>(random() % 5)};
  for (std::size_t i = 0; i < pixels; ++i) film.statistics.emplace_back(random() % 1000, random() % 2);
  return file;
}

template <class T>
void expectSame(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expectSame(const FilmFile& a, const FilmFile& b) {
  EXPECT_EQ(a.identity, b.identity);
  EXPECT_EQ(a.notes, b.notes);
  EXPECT_EQ(a.film.region, b.film.region);
  EXPECT_EQ(a.film.counts, b.film.counts);
  EXPECT_EQ(a.plan, b.plan);
  expectSame(a.film.statistics, b.film.statistics);
  ASSERT_EQ(a.film.planes.size(), b.film.planes.size());
  for (std::size_t i = 0; i < a.film.planes.size(); ++i) {
    const FilmPlane &left = a.film.planes[i], &right = b.film.planes[i];
    EXPECT_EQ(left.name, right.name);
    EXPECT_EQ(left.pixel, right.pixel);
    EXPECT_EQ(left.kind, right.kind);
    EXPECT_EQ(left.color, right.color);
    expectSame(left.sums, right.sums);
    expectSame(left.squares, right.squares);
    expectSame(left.values, right.values);
    expectSame(left.coverage, right.coverage);
  }
}

std::string problemOf(std::span<const std::byte> bytes) {
  try {
    decodeFilm(bytes, "part.qfilm");
  } catch (const FileError& error) {
    EXPECT_EQ(error.file(), "part.qfilm");
    return error.what();
  }
  return "none";
}

// Returns the bytes with a changed header and a valid checksum.
std::vector<std::byte> withHeader(const std::vector<std::byte>& bytes, const std::string& from, const std::string& to) {
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, 4);
  std::string header(reinterpret_cast<const char*>(bytes.data()) + kPrefixBytes, length);
  const std::size_t at = header.find(from);
  EXPECT_NE(at, header.npos) << from;
  header.replace(at, from.size(), to);
  std::vector<std::byte> out(bytes.begin(), bytes.begin() + kPrefixBytes);
  const auto newLength = static_cast<std::uint32_t>(header.size());
  std::memcpy(out.data() + 12, &newLength, 4);
  for (const char c : header) out.push_back(static_cast<std::byte>(c));
  out.insert(out.end(), bytes.begin() + kPrefixBytes + length, bytes.end() - kHashBytes);
  const Hash hash = Hasher().add(std::span<const std::byte>(out)).finish();
  const std::uint64_t words[] = {hash.high, hash.low};
  const auto* begin = reinterpret_cast<const std::byte*>(words);
  out.insert(out.end(), begin, begin + kHashBytes);
  return out;
}

TEST(FilmFile, RestoresEveryWord) {
  for (const bool cells : {false, true}) {
    const FilmFile file = sample(37, 21, cells);
    expectSame(decodeFilm(encodeFilm(file), "x"), file);
  }
  // A plan of which no batch is rendered yet.
  FilmFile planned = sample(37, 21, true);
  planned.film.counts.cellBatches.clear();
  expectSame(decodeFilm(encodeFilm(planned), "x"), planned);
  test::TempFolder folder;
  const FilmFile large = sample(250, 200);  // several blocks
  writeFilm(folder / "a.qfilm", large);
  expectSame(readFilm(folder / "a.qfilm"), large);
}

TEST(FilmFile, CompressesItsWords) {
  FilmFile file = sample(250, 200);
  file.film.planes.resize(1);
  EXPECT_LT(encodeFilm(file).size(), file.film.pixelCount() * (2 * 4 * sizeof(shared::FixedSum) + 8) / 2);
}

TEST(FilmFile, DetectsTruncationAtEveryLength) {
  const std::vector<std::byte> bytes = encodeFilm(sample(9, 5));
  EXPECT_EQ(problemOf(std::span(bytes).first(0)), "part.qfilm: is empty");
  for (std::size_t size = 1; size < bytes.size(); ++size)
    ASSERT_EQ(problemOf(std::span(bytes).first(size)),
              "part.qfilm: is truncated after " + std::to_string(size) + (size == 1 ? " byte" : " bytes"));
  std::vector<std::byte> longer = bytes;
  longer.resize(bytes.size() + 1);
  EXPECT_EQ(problemOf(longer), "part.qfilm: is damaged: it has 1 excess byte");
  longer.resize(bytes.size() + 3);
  EXPECT_EQ(problemOf(longer), "part.qfilm: is damaged: it has 3 excess bytes");
}

TEST(FilmFile, DetectsEveryFlippedBit) {
  const std::vector<std::byte> bytes = encodeFilm(sample(3, 2));
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    const std::size_t i = bit / 8;
    std::vector<std::byte> flipped = bytes;
    flipped[i] ^= static_cast<std::byte>(1u << bit % 8);
    const std::string problem = problemOf(flipped);
    if (i < 8)
      ASSERT_EQ(problem, "part.qfilm: is not a film file (.qfilm)") << i;
    else if (i < 12)
      ASSERT_THAT(problem, HasSubstr("version")) << i;
    else if (i >= kPrefixBytes)
      ASSERT_EQ(problem, "part.qfilm: is damaged: its checksum does not match its content") << i;
    else
      ASSERT_NE(problem, "none") << i;
  }
}

TEST(FilmFile, NamesADifferentVersion) {
  std::vector<std::byte> bytes = encodeFilm(sample(3, 2));
  bytes[8] = std::byte{2};
  EXPECT_THAT(problemOf(bytes), AllOf(HasSubstr("has version 2 "), HasSubstr("reads version 3")));
}

TEST(FilmFile, DetectsOtherFileFormats) {
  const std::string png = "\x89PNG\r\n\x1a\n and so on, and so on";
  EXPECT_THAT(problemOf(std::as_bytes(std::span(png))), AllOf(StartsWith("part.qfilm: "), HasSubstr("not a film")));
  EXPECT_THROW(readFilm("/nowhere/a.qfilm"), FileError);
}

// Forged headers with a valid checksum.
TEST(FilmFile, ChecksHeadersAgainstThePayload) {
  const std::vector<std::byte> bytes = encodeFilm(sample(9, 5));
  const std::pair<std::string, std::string> changes[] = {{"\"plan\": 0", "\"plan\": 2"},
                                                         {"\"plan\": 0", "\"plan\": 1"},
                                                         {"\"plan\"", "\"plant\""},
                                                         {"\"cells\": 0", "\"cells\": 7"},
                                                         {"\"cells\": 0", "\"cells\": -1"},
                                                         {"\"identity\"", "\"identify\""},
                                                         {"\"seed\": \"3\"", "\"seed\": 3"},
                                                         {"\"squares\"", "\"values\""},
                                                         {"\"squares\"", "\"sums\""},
                                                         {"\"squares\"", "\"roots\""},
                                                         {"\"center\"", "\"corner\""},
                                                         {"\"kind\": \"id\"", "\"kind\": \"other\""},
                                                         {"\"kind\"", "\"sort\""},
                                                         {"\"color\": true", "\"color\": 1"},
                                                         {"{", "["},
                                                         {"{", "{{"},
                                                         {"\"planes\"", "\"planes\": 1, \"x\""},
                                                         {"\"name\": \"color\"", "\"name\": 1"},
                                                         {"\"region\": [\n  5", "\"region\": [\n  65535"},
                                                         {"  9,\n", "  65530,\n"},
                                                         {"  9,\n", "  8,\n"},
                                                         {"  9,\n", "  0,\n"},
                                                         {"  9,\n", "  9.5,\n"},
                                                         {"   16\n", "   15\n"},
                                                         {"   0,\n", "   1,\n"},
                                                         {"   16\n", "   0\n"},
                                                         {"   16\n", "   32\n"},
                                                         {"   16\n", "   4294967296\n"}};
  for (const auto& [from, to] : changes) {
    const std::string problem = problemOf(withHeader(bytes, from, to));
    // Any number of samples is valid, because nothing else in the file depends on it.
    if (to == "   15\n")
      EXPECT_EQ(problem, "none");
    else
      EXPECT_TRUE(problem.starts_with("part.qfilm: header: ") || problem.starts_with("part.qfilm: payload: "))
          << from << " → " << to << ": " << problem;
  }
  EXPECT_THAT(problemOf(withHeader(bytes, "\"center\"", "\"\\u0007\"")), HasSubstr("'?' is unknown"));
  expectSame(decodeFilm(withHeader(bytes, "\"seed\"", "\"seed\""), "x"), sample(9, 5));
}

// The header states a region of 4 MiB per array, which the compressed blocks could have.
TEST(FilmFile, LimitsTheMemory) {
  const FilmFile small = sample(9, 5);
  const std::vector<std::byte> bytes = encodeFilm(small);
  MemoryBudget enough("a.qfilm", std::size_t{1} << 20), tooSmall("a.qfilm", 1000),
      lying("a.qfilm", std::size_t{1} << 20);
  expectSame(decodeFilm(bytes, "a.qfilm", enough), small);
  EXPECT_THROW(decodeFilm(bytes, "a.qfilm", tooSmall), MemoryError);
  const std::vector<std::byte> large =
      withHeader(withHeader(bytes, "  9,\n", "  1024,\n"), "  5\n", "  " + std::to_string(bytes.size() / 20) + "\n");
  EXPECT_THROW(decodeFilm(large, "a.qfilm", lying), MemoryError);
  EXPECT_THROW(decodeFilm(large, "a.qfilm"), FileError);

  const test::TempFolder folder;
  writeFilm(folder / "a.qfilm", small);
  expectSame(readFilm(folder / "a.qfilm", std::size_t{1} << 20), small);
  EXPECT_THROW(readFilm(folder / "a.qfilm", 1000), MemoryError);
}

// The arrays of a plane follow from its pixel type. Readers rely on that.
TEST(FilmFile, RejectsPlanesWithWrongArrays) {
  using program::OutputPixel;
  const auto problem = [](const auto& change) {
    FilmFile file = sample(9, 5);
    change(file.film.planes);
    return problemOf(encodeFilm(file));
  };
  const FilmFile whole = sample(9, 5);
  const FilmPlane &color = whole.film.planes[0], &depth = whole.film.planes[2], &ids = whole.film.planes[3];
  EXPECT_EQ(problem([](auto&) {}), "none");
  EXPECT_EQ(problem([](auto& planes) { planes[0].sums.clear(); }),
            "part.qfilm: header: /planes/0/arrays are not those of pixel 'mean'");
  const std::string expected[] = {"mean", "mean", "mean", "coverage", "center", "center", "coverage", "mean", "center"};
  int i = 0;
  const auto rejected = [&](std::size_t plane, const auto& change) {
    EXPECT_THAT(problem([&](auto& planes) { change(planes[plane]); }),
                testing::EndsWith(fmt::format("/planes/{}/arrays are not those of pixel '{}'", plane, expected[i])));
    ++i;
  };
  rejected(0, [](FilmPlane& p) { p.squares.clear(); });
  rejected(0, [](FilmPlane& p) { p.sums = {}, p.squares = {}; });
  rejected(1, [&](FilmPlane& p) { p.squares = color.squares; });
  rejected(0, [](FilmPlane& p) { p.pixel = OutputPixel::coverage; });
  rejected(2, [&](FilmPlane& p) { p.sums = color.sums; });
  rejected(2, [&](FilmPlane& p) { p.values = {}, p.coverage = ids.coverage; });
  rejected(3, [&](FilmPlane& p) { p.values = depth.values; });
  rejected(3, [](FilmPlane& p) { p.pixel = OutputPixel::mean; });
  rejected(0, [&](FilmPlane& p) { p = depth; });  // the first plane is the image
  EXPECT_THAT(problem([](auto& planes) { planes.clear(); }), HasSubstr("/planes is empty"));
  EXPECT_EQ(
      problem([&](auto& planes) { planes[0].sums = {}, planes[0].squares = {}, planes[0].values = depth.values; }),
      "none");
}

// Numbers of batches that no render has: they would take years, or lead to a division by 0.
TEST(FilmFile, ChecksPlansAgainstTheSamples) {
  const FilmFile good = sample(37, 21, true);
  const std::string pilot = "\"samples\": [\n  [\n   0,\n   16\n  ]\n ]";
  const std::string impossible = "part.qfilm: payload: no render has these numbers of batches";
  const std::vector<std::byte> bytes = encodeFilm(good);
  EXPECT_EQ(problemOf(withHeader(bytes, pilot, pilot)), "none");
  for (const char* samples : {"[]", "[[0, 15]]", "[[4, 16]]", "[[0, 8], [12, 16]]"})
    EXPECT_EQ(problemOf(withHeader(bytes, pilot, std::string("\"samples\": ") + samples)), impossible) << samples;
  EXPECT_EQ(problemOf(withHeader(bytes, pilot, "\"samples\": [[0, 400]]")), impossible);
  FilmFile file = good;
  file.film.counts.cellBatches[3] = 3;
  EXPECT_EQ(problemOf(encodeFilm(file)), impossible);
  for (const bool planned : {false, true}) {
    file = good;
    (planned ? file.plan : file.film.counts.cellBatches)[1] = 1u << 30;
    EXPECT_EQ(problemOf(encodeFilm(file)), impossible);
  }
}

TEST(FilmFacts, ListsEachDifferenceOnce) {
  const FilmFacts a{{"seed", "3"}, {"size", "1x1"}, {"old", "1"}}, b{{"size", "1x1"}, {"seed", "4"}, {"new", "2"}};
  const std::vector<FactDifference> found = differences(a, b);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].name, "seed");
  EXPECT_EQ(*found[0].left + *found[0].right, "34");
  EXPECT_EQ(found[1].name, "old");
  EXPECT_EQ(found[1].right, nullptr);
  EXPECT_EQ(found[2].name, "new");
  EXPECT_EQ(found[2].left, nullptr);
  EXPECT_TRUE(differences(a, a).empty());
}

}  // namespace
}  // namespace quintet::render
