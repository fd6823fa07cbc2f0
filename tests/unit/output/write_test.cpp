// SPDX-License-Identifier: Apache-2.0
// The files of a plan: their names, their contents, and the list of them.
#include "output/write.h"

#include <optional>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "base/file.h"
#include "io/codec.h"
#include "io/color.h"
#include "io/exr/exr.h"
#include "job/films.h"
#include "program/load.h"
#include "temp_folder.h"

namespace quintet::output {
namespace {

using testing::ElementsAre;

// A result of 4x3 pixels.
job::RenderResult makeResult() {
  job::RenderResult result;
  result.provenance = job::test::makeProvenance();
  result.provenance.transparent = false;
  result.film = job::viewOf(job::test::makeFilm(result.provenance, {{0, 4}}), false);
  return result;
}

std::vector<std::string> namesOf(const std::vector<WrittenFile>& files) {
  std::vector<std::string> names;
  for (const WrittenFile& file : files) names.push_back(file.path.filename());
  return names;
}

class WriteOutputs : public testing::Test {
 protected:
  std::vector<WrittenFile> write(OutputRequest request, std::optional<std::uint64_t> frame) {
    request.file = folder_ / request.file;
    job::RenderResult result = makeResult();
    result.provenance.frame = frame;
    return writeOutputs(planOutputs(request, program::loadProgram("normals")), result, observer_);
  }

  const quintet::test::TempFolder folder_;
  job::test::RecordingObserver observer_;
};

TEST_F(WriteOutputs, NamesOfFrames) {
  EXPECT_THAT(namesOf(write({.file = "f####.png", .everyFrame = true}, 7)), ElementsAre("f0007.png"));
  EXPECT_THAT(namesOf(write({.file = "f.png", .everyFrame = true}, 7)), ElementsAre("f.0007.png"));
  EXPECT_THAT(namesOf(write({.file = "f####.png", .everyFrame = true}, {})), ElementsAre("f0000.png")) << "one image";
  EXPECT_THAT(namesOf(write({.file = "f.png", .everyFrame = true}, {})), ElementsAre("f.png"));
  EXPECT_THAT(namesOf(write({.file = "f#.png"}, 7)), ElementsAre("f#.png")) << "a name that is not a pattern";
}

// As readers with color management, and programs for sequences, expect.
TEST_F(WriteOutputs, ExrStatesItsPrimariesAndItsFrameRate) {
  const auto attributeOf = [&](const job::RenderResult& result, const char* name) -> std::optional<io::ExrValue> {
    writeOutputs(planOutputs({.file = folder_ / "a.exr"}, program::loadProgram("normals")), result, observer_);
    for (const io::ExrAttribute& attribute : io::decodeExr(readFile(folder_ / "a.exr"), "a.exr").attributes)
      if (attribute.name == name) return attribute.value;
    return std::nullopt;
  };
  const io::ExrValue rec709 = io::ExrChromaticities{{0.64f, 0.33f}, {0.3f, 0.6f}, {0.15f, 0.06f}, {0.3127f, 0.329f}};
  job::RenderResult result = makeResult();
  EXPECT_EQ(attributeOf(result, "chromaticities"), rec709);
  EXPECT_EQ(attributeOf(result, "framesPerSecond"), std::nullopt);
  const std::vector<std::pair<double, io::ExrRational>> rates{
      {24.0, {24, 1}}, {23.976, {24000, 1001}}, {29.97, {30000, 1001}}, {12.5, {25, 2}}};
  for (const auto& [rate, fraction] : rates) {
    result.provenance.framesPerSecond = rate;
    EXPECT_EQ(attributeOf(result, "framesPerSecond"), io::ExrValue(fraction)) << rate;
  }
  render::FilmState data = result.film->state();
  data.planes[0].color = false;
  result.film = job::viewOf(std::move(data), false);
  EXPECT_EQ(attributeOf(result, "chromaticities"), std::nullopt) << "no colors";
}

TEST_F(WriteOutputs, PngWith16Bits) {
  const OutputRequest request{.file = "a.png", .toneMap = render::ToneMap::linear, .pngBits = 16u};
  write(request, {});
  const io::Image image = io::readImage(folder_ / "a.png");
  ASSERT_EQ(image.type, io::PixelType::u16);
  const job::RenderResult result = makeResult();
  const io::Image linear = result.film->image(0);
  for (std::uint32_t x = 0; x < 4; ++x)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(io::linearFromSrgb(static_cast<float>(image.pixel<std::uint16_t>(x, 0)[c]) / 65535.0f),
                  std::min(linear.pixel<float>(x, 0)[c] / linear.pixel<float>(x, 0)[3], 1.0f), 4e-5f);
}

// A window and a video show the same bytes as the file.
TEST_F(WriteOutputs, DisplayImageIsThatOfThePng) {
  OutputRequest request{.file = folder_ / "a.png", .exposure = -1.5, .toneMap = render::ToneMap::aces};
  const OutputPlan plan = planOutputs(request, program::loadProgram("normals"));
  const job::RenderResult result = makeResult();
  writeOutputs(plan, result, observer_);
  const io::Image display = displayImage(plan, *result.film);
  EXPECT_EQ(display.channels, 3u);
  EXPECT_EQ(display.data, io::readImage(folder_ / "a.png").data);
  request.exposure = 0.0;
  EXPECT_NE(display.data, displayImage(planOutputs(request, program::loadProgram("normals")), *result.film).data);
}

TEST(AddWritten, ListsEachFileOnce) {
  std::vector<WrittenFile> files;
  addWritten(files, {{"a.0.png", ""}, {"b.0.png", ""}});
  addWritten(files, {{"a.1.png", ""}});
  EXPECT_THAT(namesOf(files), ElementsAre("a.0.png", "b.0.png", "a.1.png"));
  addWritten(files, {{"b.0.png", "agx"}});
  EXPECT_THAT(namesOf(files), ElementsAre("a.0.png", "a.1.png", "b.0.png"));
  EXPECT_EQ(files.back().toneMap, "agx");
}

}  // namespace
}  // namespace quintet::output
