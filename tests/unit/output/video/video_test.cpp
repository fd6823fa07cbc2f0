// SPDX-License-Identifier: Apache-2.0
// Videos: names, options, the arguments of ffmpeg, and the process that encodes. A script stands for ffmpeg.
#include "output/video/video.h"

#include <gmock/gmock.h>

#include <cstdlib>

#include "base/error.h"
#include "base/file.h"
#include "job/films.h"
#include "output/write.h"
#include "program/load.h"
#include "temp_folder.h"

namespace quintet::output {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::ThrowsMessage;

TEST(Video, FormatsByExtension) {
  EXPECT_EQ(videoFormat("a.mp4"), VideoFormat::mp4);
  EXPECT_EQ(videoFormat("a.WebM"), VideoFormat::webm);
  EXPECT_EQ(videoFormat("x/a.gif"), VideoFormat::gif);
  EXPECT_EQ(videoFormat("a.png"), std::nullopt);
  EXPECT_EQ(videoFormat("mp4"), std::nullopt);
}

TEST(Video, ImagesOfFramesAreBesideTheVideo) {
  EXPECT_EQ(frameImages("x/out.mp4"), "x/out.mp4.####.png");
  EXPECT_EQ(frameImages("a#%d.gif"), "a__d.gif.####.png");
}

TEST(Video, ArgumentsOfFfmpeg) {
  const std::vector<std::string> mp4 =
      ffmpegArguments({.file = "a.mp4", .framesPerSecond = 29.97, .rateFactor = 20u}, {320, 200}, "t");
  EXPECT_THAT(mp4, IsSupersetOf({"320x200", "29.97", "libx264", "20", "yuv420p", "mp4"}));
  EXPECT_EQ(mp4.back(), "t");
  EXPECT_THAT(ffmpegArguments({.file = "a.mp4"}, {320, 200}, "t"), Contains("18"));
  EXPECT_THAT(ffmpegArguments({.file = "a.webm"}, {320, 200}, "t"), IsSupersetOf({"libvpx-vp9", "24", "webm"}));
  const std::vector<std::string> gif = ffmpegArguments({.file = "a.gif"}, {320, 200}, "t");
  EXPECT_THAT(gif, Contains(HasSubstr("palettegen")));
  EXPECT_THAT(gif, testing::Not(Contains("yuv420p")));
}

// A folder that is the only one in PATH, with a script that is called ffmpeg.
class VideoFile : public testing::Test {
 protected:
  VideoFile() : path_(std::getenv("PATH")) { ::setenv("PATH", (folder_ / "bin").c_str(), 1); }
  ~VideoFile() override { ::setenv("PATH", path_.c_str(), 1); }

  void install(const std::string& script) {
    std::filesystem::create_directory(folder_ / "bin");
    writeFile(folder_ / "bin" / "ffmpeg", "#!/bin/sh\nPATH='" + path_ + "'\n" + script);
    std::filesystem::permissions(folder_ / "bin" / "ffmpeg", std::filesystem::perms::owner_all);
  }
  // Copies its standard input into the last argument.
  void installCopy() { install("for file; do :; done\ncat > \"$file\"\n"); }

  VideoRequest request(bool resumable = false) const {
    return {.file = folder_ / "out.mp4", .framesPerSecond = 24, .rateFactor = {}, .resumable = resumable};
  }
  VideoWriter writer(const VideoRequest& request) const {
    return {request,
            planOutputs({.file = frameImages(request.file), .everyFrame = true}, program::loadProgram("normals"))};
  }
  job::RenderResult frame(std::uint64_t number) const {  // of 4x3 pixels
    job::RenderResult result;
    result.provenance = job::test::makeProvenance();
    result.provenance.transparent = false;
    result.provenance.frame = number;
    result.provenance.sceneHash += std::to_string(number);
    result.film = job::viewOf(job::test::makeFilm(result.provenance, {{0, 4}}), false);
    return result;
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      if (entry.path().filename() != "bin") names.push_back(entry.path().filename());
    std::ranges::sort(names);
    return names;
  }

  const quintet::test::TempFolder folder_;
  const std::string path_;
  job::test::RecordingObserver observer_;
};

TEST_F(VideoFile, RequiresFfmpeg) {
  EXPECT_THAT([&] { checkVideoRequest(request(), false); },
              ThrowsMessage<FileError>(AllOf(HasSubstr("out.mp4"), HasSubstr("ffmpeg, which was not found"))));
  installCopy();
  EXPECT_NO_THROW(checkVideoRequest(request(), false));
  EXPECT_THAT([&] { checkVideoRequest(request(), true); }, ThrowsMessage<UsageError>(HasSubstr("no alpha")));
  VideoRequest coarse = request();
  coarse.rateFactor = 60;
  EXPECT_THAT([&] { checkVideoRequest(coarse, false); }, ThrowsMessage<UsageError>(HasSubstr("60 is not in [0, 51]")));
}

TEST_F(VideoFile, GetsTheBytesOfAllFrames) {
  installCopy();
  VideoWriter video = writer(request());
  for (std::uint64_t i = 0; i < 3; ++i) video.add(frame(i), observer_);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.mp4")) << "no half video";
  EXPECT_TRUE(video.finish(false, observer_));
  const std::vector<std::byte> one =
      displayImage(planOutputs({.file = folder_ / "a.png"}, program::loadProgram("normals")), *frame(0).film).data;
  ASSERT_EQ(one.size(), 4u * 3 * 3);
  std::vector<std::byte> expected;
  for (int i = 0; i < 3; ++i) {
    expected.insert(expected.end(), one.begin(), one.end());
    expected.insert(expected.end(), one.end() - 4 * 3, one.end());  // sides are even: the last row is repeated
  }
  EXPECT_EQ(readFile(folder_ / "out.mp4"), expected);
  EXPECT_THAT(files(), ElementsAre("out.mp4"));
}

TEST_F(VideoFile, FailuresNameTheReasonAndLeaveNothing) {
  install("cat > /dev/null\necho 'first line' >&2\necho \"Unknown encoder 'libx264'\" >&2\nexit 3\n");
  {
    VideoWriter video = writer(request());
    video.add(frame(0), observer_);
    EXPECT_THAT([&] { video.finish(false, observer_); },
                ThrowsMessage<FileError>(HasSubstr("out.mp4: ffmpeg failed: Unknown encoder 'libx264'")));
  }
  EXPECT_THAT(files(), IsEmpty());
  install("exit 2\n");
  {
    VideoWriter video = writer(request());
    const auto many = [&] {
      for (std::uint64_t i = 0; i < 100000; ++i) video.add(frame(i), observer_);
      video.finish(false, observer_);
    };
    EXPECT_THAT(many, ThrowsMessage<FileError>(HasSubstr("ffmpeg ended with status 2"))) << "not a signal";
  }
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(VideoFile, AbandonedVideosEndTheProcess) {
  installCopy();
  writeFile(folder_ / "out.mp4", "old");
  {
    VideoWriter video = writer(request());
    video.add(frame(0), observer_);
  }
  EXPECT_THAT(files(), ElementsAre("out.mp4"));
  EXPECT_EQ(readTextFile(folder_ / "out.mp4"), "old");
}

// A killed run leaves the images of its frames; the next run reads them and removes them at the end.
TEST_F(VideoFile, ResumesFromTheImagesOfFrames) {
  installCopy();
  {
    VideoWriter video = writer(request(true));
    EXPECT_FALSE(video.addWritten(frame(0).provenance));
    video.add(frame(0), observer_);
    video.add(frame(1), observer_);
    EXPECT_FALSE(video.finish(true, observer_)) << "interrupted";
  }
  EXPECT_THAT(files(), ElementsAre("out.mp4.0000.png", "out.mp4.0001.png"));
  VideoWriter video = writer(request(true));
  EXPECT_TRUE(video.addWritten(frame(0).provenance));
  EXPECT_TRUE(video.addWritten(frame(1).provenance));
  EXPECT_FALSE(video.addWritten(frame(2).provenance));
  video.add(frame(2), observer_);
  EXPECT_TRUE(video.finish(false, observer_));
  EXPECT_THAT(files(), ElementsAre("out.mp4"));
  const std::vector<std::byte> resumed = readFile(folder_ / "out.mp4");
  VideoWriter whole = writer(request());
  for (std::uint64_t i = 0; i < 3; ++i) whole.add(frame(i), observer_);
  whole.finish(false, observer_);
  EXPECT_EQ(readFile(folder_ / "out.mp4"), resumed);
}

}  // namespace
}  // namespace quintet::output
