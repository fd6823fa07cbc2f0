// SPDX-License-Identifier: Apache-2.0
// Which files a render writes: decided, and rejected, before it starts.
#include "output/plan.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "program/load.h"
#include "temp_folder.h"

namespace quintet::output {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class PlanOutputs : public testing::Test {
 protected:
  OutputRequest request(const char* name) const { return {.file = folder_ / name}; }
  std::string errorFor(const OutputRequest& request) const {
    try {
      planOutputs(request, program_);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  const quintet::test::TempFolder folder_;
  const program::Program program_ = program::loadProgram("pathtracer");
};

TEST_F(PlanOutputs, TheFirstOutputByDefault) {
  const OutputPlan plan = planOutputs(request("out.png"), program_);
  EXPECT_EQ(plan.kind, FileKind::png);
  EXPECT_THAT(plan.outputs, ElementsAre(0u));
  EXPECT_TRUE(plan.layers.empty());
  EXPECT_TRUE(plan.optionalOutputs.empty());
  EXPECT_EQ(planOutputs(request("OUT.EXR"), program_).kind, FileKind::exr);
  EXPECT_EQ(planOutputs(request("out.hdr"), program_).kind, FileKind::hdr);
  EXPECT_EQ(planOutputs(request("out.qfilm"), program_).kind, FileKind::film);
}

TEST_F(PlanOutputs, LayersRequireTheirOutputs) {
  OutputRequest layers = request("out.exr");
  layers.layers = {"variance", "albedo", "cryptomatte_object"};
  const OutputPlan plan = planOutputs(layers, program_);
  EXPECT_THAT(plan.optionalOutputs, testing::UnorderedElementsAre("albedo", "cryptomatte_object"));
  EXPECT_EQ(plan.layers.size(), 3u);
  const job::OutputNotes notes = plan.notes();
  EXPECT_TRUE(notes.names) << "Cryptomatte needs the names of objects";
  EXPECT_THAT(notes.layers, HasSubstr("albedo"));
  layers.layers = {"all"};
  EXPECT_EQ(planOutputs(layers, program_).layers.size(), availableLayers(program_).size());
}

TEST_F(PlanOutputs, AllOutputsSkipsCoverage) {
  OutputRequest all = request("out.exr");
  all.allOutputs = true;
  for (const std::size_t output : planOutputs(all, program_).outputs)
    EXPECT_NE(program_.outputs[output].pixel, program::OutputPixel::coverage);
}

TEST_F(PlanOutputs, RejectsWhatCannotBeWritten) {
  EXPECT_THAT(errorFor(request("out.jpg")), HasSubstr(".png, .exr, .hdr or .qfilm"));
  EXPECT_THAT(errorFor(request("no/such/folder/out.png")), HasSubstr("no/such/folder"));
  OutputRequest wrong = request("out.png");
  wrong.layers = {"albedo"};
  EXPECT_THAT(errorFor(wrong), HasSubstr(".exr"));
  wrong = request("out.exr");
  wrong.layers = {"albdo"};
  EXPECT_THAT(errorFor(wrong), HasSubstr("did you mean 'albedo'?"));
  wrong.layers = {"albedo"};
  wrong.allOutputs = true;
  EXPECT_THAT(errorFor(wrong), HasSubstr("exclude"));
  wrong = request("out.png");
  wrong.exr.emplace();
  EXPECT_THAT(errorFor(wrong), HasSubstr(".exr"));
  wrong = request("out.png");
  wrong.output = "nothing";
  EXPECT_THAT(errorFor(wrong), HasSubstr("'nothing'"));
  wrong.output = "cryptomatte_object";
  EXPECT_THAT(errorFor(wrong), HasSubstr("counts ids"));
  OutputRequest standardOutput{.file = "-"};
  EXPECT_EQ(errorFor(standardOutput), "");
  standardOutput.allOutputs = true;
  EXPECT_THAT(errorFor(standardOutput), HasSubstr("standard output"));
}

// Programs have heat maps only on request, films only if they were rendered.
TEST_F(PlanOutputs, SuggestsHeatMapsOfProgramsOnly) {
  OutputRequest wrong = request("out.exr");
  wrong.layers = {"heat_ray"};
  EXPECT_THAT(errorFor(wrong), HasSubstr("did you mean 'heat_rays'?"));
  try {
    selectLayers(availableLayers(program_), {"heat_rays"}, "these films");
    ADD_FAILURE();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("layer 'heat_rays' not found in these films; available: "));
  }
}

TEST_F(PlanOutputs, StandardOutput) {
  EXPECT_EQ(planOutputs({.file = "-"}, program_).kind, FileKind::png);
  EXPECT_EQ(planOutputs({.file = "-.exr"}, program_).kind, FileKind::exr);
  OutputRequest layers{.file = "-.exr"};
  layers.layers = {"albedo"};
  EXPECT_EQ(planOutputs(layers, program_).layers.size(), 1u);
  EXPECT_TRUE(isStandardOutput("-.hdr"));
  EXPECT_FALSE(isStandardOutput("./-.exr"));
  EXPECT_FALSE(isStandardOutput("a-.exr"));
  EXPECT_THAT(errorFor({.file = "-.qfilm"}), HasSubstr("film"));
  EXPECT_THAT(errorFor({.file = "-.exr", .everyFrame = true}), HasSubstr("standard output"));
}

// Each frame of an animation is an image; the frames of a program that accumulates lead to one.
TEST_F(PlanOutputs, FramesOfAnimationsAreNumbered) {
  const auto numbers = [&](const program::Program& program, const job::FrameRequest& frames,
                           const char* file = "a.png") {
    return planOutputs({.file = folder_ / file}, program, frames).request.everyFrame;
  };
  EXPECT_TRUE(numbers(program_, {.count = 2}));
  EXPECT_TRUE(numbers(program_, {.count = 2, .first = 5}));
  EXPECT_FALSE(numbers(program_, {.count = 1, .first = 5}));
  EXPECT_FALSE(numbers(program_, {}));
  EXPECT_THROW(numbers(program_, {.count = 2}, "-"), UsageError);
  program::Program accumulating = program_;
  accumulating.accumulation = program::Accumulation::program;
  EXPECT_FALSE(numbers(accumulating, {.count = 2}));
}

TEST_F(PlanOutputs, BitsOfPngFiles) {
  OutputRequest deep = request("out.png");
  deep.pngBits = 16;
  EXPECT_EQ(errorFor(deep), "");
  deep.pngBits = 12;
  EXPECT_THAT(errorFor(deep), HasSubstr("8 or 16"));
  deep.pngBits = 1;
  EXPECT_THAT(errorFor(deep), HasSubstr("1 bit per channel"));
  deep = request("out.exr");
  deep.pngBits = 16;
  EXPECT_THAT(errorFor(deep), HasSubstr("PNG only"));
}

// A folder has the name of one of the files.
TEST_F(PlanOutputs, ChecksEachFile) {
  OutputRequest all = request("out.exr");
  all.allOutputs = true;
  EXPECT_EQ(errorFor(all), "");
  std::filesystem::create_directory(folder_ / "out.albedo.exr");
  EXPECT_THAT(errorFor(all), HasSubstr("out.albedo.exr"));
  OutputRequest frames = request("f##.png");
  frames.everyFrame = true;
  std::filesystem::create_directory(folder_ / "f07.png");
  EXPECT_NO_THROW(planOutputs(frames, program_, {.count = 7}));
  EXPECT_THROW(planOutputs(frames, program_, {.count = 8}), FileError);
  EXPECT_NO_THROW(planOutputs(frames, program_, {.count = 3, .first = 8}));
  EXPECT_EQ(folder_.entryCount(), 2u) << "the check leaves no files";
}

TEST_F(PlanOutputs, DisplaySettingsApplyToPngOnly) {
  OutputRequest bright = request("out.exr");
  bright.exposure = 1.0f;
  EXPECT_THAT(ignoredDisplayText(bright), HasSubstr("out.exr"));
  bright.file = folder_ / "out.png";
  EXPECT_EQ(ignoredDisplayText(bright), "");
}

TEST(Layers, NamesThatCryptomatteReadersConfuse) {
  Layer object{.name = "cryptomatte_object", .source = Layer::Source::coverage},
      object2{.name = "cryptomatte_object2", .source = Layer::Source::coverage};
  EXPECT_NO_THROW(checkChannels({object}));
  EXPECT_THROW(checkChannels({object, object2}), UsageError);
  object2.name = "object";  // both would be CryptoObject
  EXPECT_THROW(checkChannels({object, object2}), UsageError);
}

}  // namespace
}  // namespace quintet::output
