// SPDX-License-Identifier: Apache-2.0
// Sessions of pages: a worker process each, on the device.
#include <signal.h>  // NOLINT: kill() of POSIX

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

#include "base/file.h"
#include "io/codec.h"
#include "lab/project_folder.h"
#include "page_client.h"
#include "temp_folder.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

// One color, which a uniform decides.
constexpr const char* kPlain = R"(/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};
/**** COMMON END ****/
/**** RAY GENERATION SHADER ****/
uniform vec3 shade;  // defaultval="0.0, 1.0, 0.0"
void main() {
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 100.0, 0.0), 0.001, vec3(0.0, 1.0, 0.0), 1000.0, 0);
  gsnSetPixel(vec4(shade * payload.color, 1.0));
}
/**** CLOSEST-HIT SHADER ****/
void main() {
  payload.color = vec3(0.5);
}
/**** MISS SHADER ****/
void main() {
  payload.color = vec3(1.0);
}
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return text.replace(at, from.size(), to);
}

// The loop depends on what the trace returns, so that no compiler removes it.
std::string endless() {
  return replaced(
      kPlain, "  gsnSetPixel(",
      "  while (payload.color.x > -1.0) {\n"
      "    traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, payload.color, 0.001, vec3(0.0, 1.0, 0.0), "
      "1000.0, 0);\n  }\n  gsnSetPixel(");
}

// The average color of a PNG, sRGB bytes.
std::vector<int> colorOf(const ReceivedImage& image) {
  const io::Image decoded = io::decodeImage(std::as_bytes(std::span(image.file)), "image");
  const auto pixel = decoded.pixel<std::uint8_t>(decoded.width / 2, decoded.height / 2);
  return {pixel[0], pixel[1], pixel[2]};
}

bool isLossless(const lab::ImageHeader& header) { return header.format == lab::ImageFormat::png; }

class LabSession : public ::testing::Test {
 protected:
  LabSession() {
    fs::create_directories(folder_ / "mine");
    save(kPlain);
  }
  void save(const std::string& text) const { writeFile(folder_ / "mine/mine.rt.glsl", text); }
  LabProcess start(std::vector<std::string> options = {}) const {
    options.insert(options.end(), {"--size", "64x36", "--spp", "4"});
    return LabProcess(folder_.path(), options);
  }
  static Json open(const std::string& program = "mine") {
    return {{"do", "open"}, {"program", program}, {"samples", 4}, {"id", 1}};
  }
  static Json done(PageClient& page, const Json& id) {
    return page.waitFor([&](const Json& event) { return event.value("event", "") == "done" && event.at("id") == id; });
  }

  const TempFolder folder_;
};

TEST_F(LabSession, OpensEditsBreaksAndFixesAProgram) {
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  const Json opened = page.waitFor("opened");
  EXPECT_EQ(opened.at("program"), "mine");
  EXPECT_EQ(opened.at("description").at("parameters").at(0).at("name"), "shade");
  EXPECT_THAT(colorOf(page.waitForImage(isLossless)), ::testing::ElementsAre(0, 255, 0));

  // An edit through the server.
  const std::string etag = "\"" + lab::contentHash(kPlain) + "\"";
  const std::string red = replaced(kPlain, "\"0.0, 1.0, 0.0\"", "\"1.0, 0.0, 0.0\"");
  EXPECT_EQ(server.request("PUT", "/api/files/mine/mine.rt.glsl", red, {{"if-match", etag}}).status, 200u);
  page.waitFor("reloaded");
  EXPECT_THAT(colorOf(page.waitForImage(isLossless)), ::testing::ElementsAre(255, 0, 0));

  // An error of an editor outside of the page.
  save(replaced(red, "payload.color = vec3(1.0)", "payload.color = vec3(1.0"));
  const Json broken = page.waitFor("diagnostics");
  EXPECT_EQ(broken.at("outdated"), true);
  ASSERT_FALSE(broken.at("diagnostics").empty());
  EXPECT_EQ(broken.at("diagnostics").at(0).at("file"), "mine/mine.rt.glsl");
  EXPECT_EQ(broken.at("diagnostics").at(0).at("line"), 18);
  EXPECT_EQ(broken.at("diagnostics").at(0).at("severity"), "error");

  save(replaced(red, "\"1.0, 0.0, 0.0\"", "\"0.0, 0.0, 1.0\""));
  const Json fixed = page.waitFor("diagnostics");
  EXPECT_EQ(fixed.at("outdated"), false);
  EXPECT_TRUE(fixed.at("diagnostics").empty());
  EXPECT_THAT(colorOf(page.waitForImage(isLossless)), ::testing::ElementsAre(0, 0, 255));
}

TEST_F(LabSession, OpensABrokenProgramOnceItIsFixed) {
  save(replaced(kPlain, "payload.color = vec3(0.5);", "payload.color = vec2(0.5);"));
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  const Json broken = page.waitFor("diagnostics");
  EXPECT_EQ(broken.at("outdated"), false);  // there is no image
  EXPECT_EQ(broken.at("diagnostics").at(0).at("line"), 14);
  EXPECT_EQ(page.waitFor("error").at("id"), 1);
  save(kPlain);
  EXPECT_THAT(colorOf(page.waitForImage(isLossless)), ::testing::ElementsAre(0, 255, 0));
}

TEST_F(LabSession, AnswersCommands) {
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  page.waitForImage(isLossless);
  page.send({{"do", "set"}, {"parameter", "shade"}, {"value", {0, 0, 1}}, {"id", "blue"}});
  done(page, "blue");
  const Json state = page.waitFor("state");
  EXPECT_EQ(state.at("parameters").at("shade"), Json({0.0, 0.0, 1.0}));
  EXPECT_EQ(state.at("canUndo"), true);
  EXPECT_THAT(colorOf(page.waitForImage(isLossless)), ::testing::ElementsAre(0, 0, 255));
  page.send({{"do", "value"}, {"x", 3}, {"y", 4}, {"id", 2}});
  const Json value = page.waitFor("value");
  EXPECT_EQ(value.at("id"), 2);
  EXPECT_EQ(value.at("value"), Json({0.0, 0.0, 1.0, 1.0}));
  page.send({{"do", "explain"}, {"x", 3}, {"y", 4}, {"id", 3}});
  const Json explained = page.waitFor("explained");
  EXPECT_EQ(explained.at("id"), 3);
  EXPECT_THAT(explained.dump(), HasSubstr("mine/mine.rt.glsl"));
  page.send({{"do", "graph"}, {"id", 4}});
  const Json graph =
      page.waitFor([](const Json& event) { return event.value("event", "") == "graph" && event.contains("id"); });
  EXPECT_EQ(graph.at("graph").at("stages").size(), 3u);
  page.send({{"do", "orbitt"}, {"id", 5}});
  EXPECT_THAT(page.waitFor("error").at("message").get<std::string>(), HasSubstr("did you mean 'orbit'?"));
  page.send({{"do", "size"}, {"width", 32}, {"height", 18}});
  const ReceivedImage small = page.waitForImage(isLossless);
  EXPECT_EQ(small.header.size, uvec2(32, 18));
}

// Each frame has its number as red, in steps of 1/255.
constexpr const char* kCount = R"(void main() { /**** RAY GENERATION SHADER ****/
  gsnSetPixel(vec4(float(frameID) / 255.0, float(gl_LaunchIDEXT.x) / 255.0, 0.0, 1.0));
}
)";

TEST_F(LabSession, RendersOneFrameIfAllAreEqual) {
  const LabProcess server = start();
  PageClient page(server);
  Json endlessFrames = open();
  endlessFrames.erase("samples");
  page.send(endlessFrames);
  EXPECT_EQ(page.waitFor("state").at("still"), true);
  const auto isComplete = [](const lab::ImageHeader& header) { return header.complete && isLossless(header); };
  EXPECT_EQ(page.waitForImage(isComplete).header.samples, 1u);
  // Nothing is rendered until something changes, also not if the page asks for a frame.
  page.send({{"do", "advance"}, {"frames", 3}});
  page.send({{"do", "pause"}, {"on", false}});
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  page.send({{"do", "pause"}, {"on", false}, {"id", 2}});
  std::size_t images = 0;
  page.waitFor([&](const Json& event) {
    images += event.value("event", "") == "image";
    return event.value("event", "") == "done" && event.at("id") == 2;
  });
  EXPECT_EQ(images, 0u);
  // Changes of parameters and of the display.
  page.send({{"do", "set"}, {"parameter", "shade"}, {"value", {0, 0, 1}}});
  page.waitFor("restarted");
  EXPECT_THAT(colorOf(page.waitForImage(isComplete)), ::testing::ElementsAre(0, 0, 255));
  page.send({{"do", "exposure"}, {"stops", -1}});
  EXPECT_LT(colorOf(page.waitForImage(isComplete))[2], 200);
  page.send({{"do", "exposure"}, {"stops", 0}});
  // An edit that uses the number of the frame.
  save(kCount);
  page.waitFor("reloaded");
  EXPECT_EQ(page.waitFor("state").at("still"), false);
  page.waitForImage([](const lab::ImageHeader& header) { return header.factor == 1 && header.samples > 3; });
}

TEST_F(LabSession, ShowsAFrameAlsoAfterAChange) {
  save("uniform float shade;  // defaultval=\"0\"\n" + replaced(kCount, "255.0, 0.0, 1.0", "255.0, shade, 1.0"));
  const LabProcess server = start();
  PageClient page(server);
  Json endlessFrames = open();
  endlessFrames.erase("samples");
  page.send(endlessFrames);
  page.waitForImage([](const lab::ImageHeader& header) { return header.factor == 1 && header.samples > 3; });
  const auto isAt = [](std::uint32_t frames) {
    return [frames](const lab::ImageHeader& header) { return header.samples >= frames && isLossless(header); };
  };
  for (const std::uint32_t frames : {1u, 6u}) {
    page.send({{"do", "pause"}, {"on", true}});
    page.send({{"do", "rewind"}, {"id", 2}});
    page.send({{"do", "advance"}, {"until", frames}});
    done(page, 2);
    const ReceivedImage image = page.waitForImage(isAt(frames));
    EXPECT_EQ(image.header.samples, frames);
    EXPECT_EQ(colorOf(image)[0], static_cast<int>(frames) - 1);
  }
  page.send({{"do", "set"}, {"parameter", "shade"}, {"value", 1}});
  page.waitFor("restarted");
  const ReceivedImage changed = page.waitForImage(isAt(6));
  EXPECT_EQ(changed.header.samples, 6u);
  EXPECT_EQ(colorOf(changed)[2], 255);
}

TEST_F(LabSession, ShowsAnEditWhileFramesArePaused) {
  save(kCount);
  const LabProcess server = start();
  PageClient page(server);
  Json endlessFrames = open();
  endlessFrames.erase("samples");
  page.send(endlessFrames);
  page.waitForImage([](const lab::ImageHeader& header) { return header.factor == 1 && header.samples > 3; });
  page.send({{"do", "pause"}, {"id", 2}});
  done(page, 2);
  page.waitForImage(isLossless);
  save(replaced(kCount, "float(gl_LaunchIDEXT.x) / 255.0, 0.0, 1.0", "0.0, 1.0, 1.0"));
  page.waitFor("reloaded");
  const ReceivedImage first =
      page.waitForImage([](const lab::ImageHeader& header) { return header.factor == 1 && isLossless(header); });
  EXPECT_EQ(first.header.samples, 1u);
  EXPECT_THAT(colorOf(first), ::testing::ElementsAre(0, 0, 255));
}

TEST_F(LabSession, ReportsWhatImagesShow) {
  const std::string notFinite = replaced(kPlain, "shade * payload.color", "shade / shade.x");
  save(notFinite);
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  const auto hasId = [](const std::string& id) {
    return [id](const Json& event) {
      return event.value("event", "") == "diagnostics" && !event.at("diagnostics").empty() &&
             event.at("diagnostics").back().value("id", "") == id;
    };
  };
  const Json found = page.waitFor(hasId("Q002"));
  EXPECT_EQ(found.at("outdated"), false);
  EXPECT_EQ(found.at("diagnostics").back().at("severity"), "warning");
  EXPECT_EQ(found.at("diagnostics").back().at("text"),
            "2304 pixels of the output 'image' were not finite in at least one frame; the first is at pixel (0, 0), "
            "counted from the top left corner");
  EXPECT_THAT(found.at("diagnostics").back().at("why").get<std::string>(), HasSubstr("NaN"));
  const auto isEmpty = [](const Json& event) {
    return event.value("event", "") == "diagnostics" && event.at("diagnostics").empty();
  };
  // A parameter repairs it, and brings it back.
  page.send({{"do", "set"}, {"parameter", "shade"}, {"value", {1, 1, 1}}});
  page.waitFor(isEmpty);
  page.send({{"do", "undo"}});
  page.waitFor(hasId("Q002"));
  // An error replaces it, and the version before the error has it again.
  save(replaced(notFinite, "shade / shade.x", "shade / nothing"));
  page.waitFor(hasId("GLSL"));
  save(kPlain);
  page.waitFor(isEmpty);
}

TEST_F(LabSession, ChecksAtRunTime) {
  save(replaced(kPlain, "shade * payload.color", "shade / shade.x"));
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  page.waitForImage(isLossless);
  page.send({{"do", "instrument"}, {"id", 2}});
  const Json found = page.waitFor([](const Json& event) {
    return event.value("event", "") == "diagnostics" && !event.at("diagnostics").empty() &&
           event.at("diagnostics").back().value("file", "") == "mine/mine.rt.glsl";
  });
  EXPECT_EQ(found.at("diagnostics").back().at("id"), "Q002");
  EXPECT_EQ(found.at("diagnostics").back().at("line"), 10);
  done(page, 2);
  // The findings are of the values that were shown.
  page.send({{"do", "set"}, {"parameter", "shade"}, {"value", {1, 1, 1}}});
  page.waitFor(
      [](const Json& event) { return event.value("event", "") == "diagnostics" && event.at("diagnostics").empty(); });
}

TEST_F(LabSession, ReportsTracesThatAreTooDeep) {
  save("// gsnShaderOptions: precompiler=\"GL_EXT_ray_tracing, recursion: 2\"\n" +
       replaced(kPlain, "payload.color = vec3(1.0);",
                "payload.color.x += 1.0;\n"
                "  if (payload.color.x < 5.0) traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, "
                "vec3(0.0, 100.0, 0.0), 0.001, vec3(0.0, 1.0, 0.0), 1000.0, 0);"));
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  const Json found = page.waitFor([](const Json& event) {
    return event.value("event", "") == "diagnostics" && !event.at("diagnostics").empty() &&
           event.at("diagnostics").back().value("id", "") == "Q003";
  });
  EXPECT_THAT(found.at("diagnostics").back().at("text").get<std::string>(), HasSubstr("recursion depth 2"));
}

TEST_F(LabSession, PausesAndAdvancesFrames) {
  save(kCount);
  const LabProcess server = start();
  PageClient page(server);
  Json endlessFrames = open();
  endlessFrames.erase("samples");
  page.send(endlessFrames);
  const Json state = page.waitFor("state");
  ASSERT_EQ(state.at("frames"), true);
  page.waitForImage([](const lab::ImageHeader& header) { return header.factor == 1 && header.samples > 3; });
  page.send({{"do", "pause"}, {"id", 2}});
  done(page, 2);
  const ReceivedImage paused = page.waitForImage(isLossless);
  std::uint32_t frames = paused.header.samples;
  for (const std::uint32_t count : {1u, 1u, 3u}) {
    page.send({{"do", "advance"}, {"frames", count}});
    frames += count;
    page.waitForImage([&](const lab::ImageHeader& header) { return header.samples == frames && isLossless(header); });
  }
  // Nothing more is rendered.
  page.send({{"do", "value"}, {"x", 0}, {"y", 0}});
  page.waitFor("value");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  page.send({{"do", "pause"}, {"on", true}, {"id", 3}});
  std::size_t images = 0;
  page.waitFor([&](const Json& event) {
    images += event.value("event", "") == "image";
    return event.value("event", "") == "done" && event.at("id") == 3;
  });
  EXPECT_EQ(images, 0u);
}

TEST_F(LabSession, RewindsToTheFirstFrameInTheSameProcess) {
  save(kCount);
  const LabProcess server = start();
  PageClient page(server);
  Json endlessFrames = open();
  endlessFrames.erase("samples");
  page.send(endlessFrames);
  page.waitForImage([](const lab::ImageHeader& header) { return header.factor == 1 && header.samples > 3; });
  page.send({{"do", "pause"}, {"id", 2}});
  done(page, 2);
  EXPECT_GT(colorOf(page.waitForImage(isLossless))[0], 2);
  page.send({{"do", "rewind"}, {"id", 3}});
  std::size_t openings = 0;
  page.waitFor([&](const Json& event) {
    openings += event.value("event", "") == "worker" || event.value("event", "") == "opened";
    return event.value("event", "") == "done" && event.at("id") == 3;
  });
  EXPECT_EQ(openings, 0u) << "the program is not opened again";
  const ReceivedImage first =
      page.waitForImage([](const lab::ImageHeader& header) { return header.samples == 1 && isLossless(header); });
  EXPECT_EQ(colorOf(first)[0], 0);
  // It is still paused, and the next frame is the second one.
  page.send({{"do", "advance"}});
  const ReceivedImage second =
      page.waitForImage([](const lab::ImageHeader& header) { return header.samples > 1 && isLossless(header); });
  EXPECT_EQ(second.header.samples, 2u);
  EXPECT_EQ(colorOf(second)[0], 1);
}

// A script that stands for ffmpeg: the video is its input. Only for servers that start while it exists.
class FakeFfmpeg {
 public:
  explicit FakeFfmpeg(const fs::path& folder) : before_(std::getenv("PATH")) {
    fs::create_directories(folder / "bin");
    writeFile(folder / "bin/ffmpeg", "#!/bin/sh\nfor file; do :; done\ncat > \"$file\"\n");
    fs::permissions(folder / "bin/ffmpeg", fs::perms::owner_all);
    ::setenv("PATH", ((folder / "bin").string() + ":" + before_).c_str(), 1);
  }
  ~FakeFfmpeg() { ::setenv("PATH", before_.c_str(), 1); }
  FakeFfmpeg(const FakeFfmpeg&) = delete;
  FakeFfmpeg& operator=(const FakeFfmpeg&) = delete;

 private:
  const std::string before_;
};

TEST_F(LabSession, MakesAVideoOfTheFramesOfAProgram) {
  save(kCount);
  const FakeFfmpeg ffmpeg(folder_.path());
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  page.waitForImage([](const lab::ImageHeader& header) { return header.samples > 2; });  // it starts over
  page.send({{"do", "video"}, {"frames", 5}, {"fps", 10}, {"format", "mp4"}, {"id", 2}});
  const Json file = page.waitFor("file");
  EXPECT_EQ(file.at("id"), 2);
  EXPECT_EQ(file.at("type"), "video/mp4");
  std::vector<int> progress;
  for (const Json& event : page.events())
    if (event.value("event", "") == "progress") progress.push_back(event.at("done"));
  EXPECT_THAT(progress, ::testing::ElementsAre(1, 2, 3, 4, 5));
  const std::string frames = page.readFile(file);
  ASSERT_EQ(frames.size(), 5u * 64 * 36 * 3);
  for (std::size_t frame = 0; frame < 5; ++frame) {
    const std::size_t pixel = (frame * 64 * 36 + 7) * 3;
    EXPECT_EQ(static_cast<int>(frames[pixel]), static_cast<int>(frame));
    EXPECT_EQ(static_cast<int>(frames[pixel + 1]), 7);
  }
}

TEST_F(LabSession, MakesAVideoOfATurnOfTheCamera) {
  const FakeFfmpeg ffmpeg(folder_.path());
  const LabProcess server = start();
  PageClient page(server);
  page.send(open("<programs/normals>"));
  done(page, 1);
  page.send({{"do", "video"}, {"frames", 3}, {"format", "gif"}, {"id", 2}});
  EXPECT_THAT(page.waitFor("error").at("message").get<std::string>(), HasSubstr("nothing moves"));
  page.send({{"do", "video"}, {"frames", 3}, {"format", "gif"}, {"turn", true}, {"id", 3}});
  const std::string frames = page.readFile(page.waitFor("file"));
  const std::size_t size = std::size_t{64} * 36 * 3;
  ASSERT_EQ(frames.size(), 3 * size);
  EXPECT_NE(frames.substr(0, size), frames.substr(size, size));
  EXPECT_NE(frames.substr(size, size), frames.substr(2 * size));
}

TEST_F(LabSession, NeedsFfmpegForVideos) {
  save(kCount);
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", folder_.path().c_str(), 1);
  const LabProcess server = start();
  ::setenv("PATH", path.c_str(), 1);
  PageClient page(server);
  page.send(open());
  page.waitForImage([](const lab::ImageHeader& header) { return header.complete && isLossless(header); });
  page.send({{"do", "video"}, {"frames", 2}, {"id", 2}});
  const Json error = page.waitFor("error");
  EXPECT_EQ(error.at("id"), 2);
  EXPECT_THAT(error.at("message").get<std::string>(), HasSubstr("require the program ffmpeg"));
  page.send({{"do", "value"}, {"x", 1}, {"y", 1}, {"id", 3}});  // the session goes on
  page.waitFor("value");
}

TEST_F(LabSession, ExportsTheImageAsOpenExr) {
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  page.waitForImage([](const lab::ImageHeader& header) { return header.complete && isLossless(header); });
  page.send({{"do", "set"}, {"parameter", "shade"}, {"value", {0.1, 0.25, 0.5}}, {"id", 2}});
  done(page, 2);
  page.waitForImage([](const lab::ImageHeader& header) { return header.complete && isLossless(header); });
  page.send({{"do", "exr"}, {"id", 3}});
  const Json file = page.waitFor("file");
  EXPECT_EQ(file.at("name"), "image.exr");
  const std::string content = page.readFile(file);
  const io::Image image = io::decodeImage(std::as_bytes(std::span(content)), "image.exr");
  EXPECT_EQ(uvec2(image.width, image.height), uvec2(64, 36));
  ASSERT_EQ(image.type, io::PixelType::f32);
  // A program of the lecture form writes display values; the file has linear ones, with all bits of a float.
  page.send({{"do", "value"}, {"x", 3}, {"y", 4}, {"width", 8}, {"height", 2}, {"id", 4}});
  const Json value = page.waitFor("value").at("value");
  for (std::size_t channel = 0; channel < 3; ++channel)
    EXPECT_FLOAT_EQ(image.pixel<float>(3, 4)[channel], value.at(channel).get<float>());
  EXPECT_NEAR(image.pixel<float>(3, 4)[1], 0.0508760884, 1e-7);  // 0.25 of sRGB; a half differs by 1e-5
}

TEST_F(LabSession, MeasuresBlocksOfPixels) {
  save(kCount);
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  page.waitForImage([](const lab::ImageHeader& header) { return header.complete && isLossless(header); });
  const auto green = [&](const Json& block) {
    Json command{{"do", "value"}, {"id", 2}};
    command.update(block);
    page.send(command);
    return page.waitFor("value").at("value").at(1).get<double>();
  };
  double sum = 0;
  for (int x = 10; x < 14; ++x) sum += green({{"x", x}, {"y", 5}});
  EXPECT_NEAR(green({{"x", 10}, {"y", 5}, {"width", 4}, {"height", 3}}), sum / 4, 1e-6);
  page.send({{"do", "value"}, {"x", 60}, {"y", 5}, {"width", 5}, {"height", 3}, {"id", 3}});
  EXPECT_THAT(page.waitFor("error").at("message").get<std::string>(), HasSubstr("not inside the image"));
}

TEST_F(LabSession, ReportsStatisticsWhileFramesPlay) {
  save(kCount);
  const LabProcess server = start();
  PageClient page(server);
  Json endlessFrames = open();
  endlessFrames.erase("samples");
  page.send(endlessFrames);
  int samples = 0;
  for (int i = 0; i < 2; ++i) {
    const Json statistics = page.waitFor("statistics");
    EXPECT_EQ(statistics.at("frames"), true);
    EXPECT_GT(statistics.at("samples"), samples);
    EXPECT_GT(statistics.at("seconds"), 0);
    samples = statistics.at("samples");
  }
}

TEST_F(LabSession, IncludesFilesOfTheProjectOnly) {
  fs::create_directory(folder_ / "inner");
  fs::create_directory(folder_ / "inner/mine");
  writeFile(folder_ / "secret.glsl", "const vec3 kShade = vec3(1.0);\n");
  writeFile(folder_ / "inner/shared.glsl", "const vec3 kShade = vec3(0.0, 0.0, 1.0);\n");
  fs::create_symlink(folder_ / "secret.glsl", folder_ / "inner/mine/link.glsl");
  const auto saveWith = [&](const std::string& include) {
    writeFile(folder_ / "inner/mine/mine.rt.glsl",
              "#include \"" + include + "\"\n" + replaced(kPlain, "shade * payload", "kShade * payload"));
  };
  const LabProcess server(folder_ / "inner", {"--size", "16x16", "--spp", "1"});
  for (const std::string& include :
       {std::string("../../secret.glsl"), (folder_ / "secret.glsl").string(), std::string("link.glsl")}) {
    saveWith(include);
    PageClient page(server);
    page.send(open());
    const Json broken = page.waitFor("diagnostics").at("diagnostics");
    ASSERT_FALSE(broken.empty()) << include;
    EXPECT_THAT(broken.dump(), HasSubstr("file not found")) << include;
    EXPECT_THAT(server.request("GET", "/api/program?name=mine").body, ::testing::Not(HasSubstr("vec3 kShade")));
  }
  saveWith("../shared.glsl");
  PageClient page(server);
  page.send(open());
  EXPECT_THAT(colorOf(page.waitForImage(isLossless)), ::testing::ElementsAre(0, 0, 255));
}

TEST_F(LabSession, ScenesReadFilesOfTheProjectOnly) {
  fs::create_directories(folder_ / "inner/scenes");
  const auto png = io::encodePng(io::makeImage(2, 2, 3, io::PixelType::u8, io::ColorEncoding::sRgb));
  writeFile(folder_ / "secret.png", png);
  writeFile(folder_ / "inner/mine.png", png);
  const LabProcess server(folder_ / "inner", {"--size", "16x16", "--spp", "1"});
  const auto errorsWith = [&](const std::string& image) {
    writeFile(folder_ / "inner/scenes/a.scene.toml", "[[material]]\nname = 'a'\nbase_color_texture = '" + image +
                                                         "'\n[[mesh]]\nshape = 'quad'\nmaterial = 'a'\n");
    PageClient page(server);
    Json command = open("<programs/normals>");
    command["scene"] = "scenes/a.scene.toml";
    page.send(command);
    return page.waitFor("diagnostics").at("diagnostics").dump();
  };
  EXPECT_EQ(errorsWith("../mine.png"), "[]");
  for (const std::string& image : {std::string("../../secret.png"), (folder_ / "secret.png").string()})
    EXPECT_THAT(errorsWith(image), HasSubstr("is outside of the project"));
}

TEST_F(LabSession, ReachesNoFileOutsideOfTheProject) {
  fs::create_directory(folder_ / "inner");
  const LabProcess server(folder_ / "inner", {"--size", "16x16"});
  PageClient page(server);
  for (const char* program : {"../mine", "/etc", "mine", "."}) {
    page.send(open(program));
    EXPECT_EQ(page.waitFor("error").at("id"), 1) << program;
  }
  Json scene = open("<programs/normals>");
  scene["scene"] = "../a.glb";
  page.send(scene);
  EXPECT_THAT(page.waitFor("error").at("message").get<std::string>(), HasSubstr("is not a name"));
  page.send(open("<programs/normals>"));
  done(page, 1);
  page.send({{"do", "environment"}, {"source", "/etc/passwd"}});
  EXPECT_THAT(page.waitFor("error").at("message").get<std::string>(), HasSubstr("is not a name"));
}

// The worker can be opening the first program before the others arrive, which takes it longer than sending them.
TEST_F(LabSession, OpensOnlyTheLastOfSeveralPrograms) {
  const LabProcess server = start();
  PageClient page(server);
  for (int number = 1; number <= 3; ++number) {
    Json command = open(number == 3 ? "mine" : "<programs/pathtracer>");
    command["number"] = number;
    command["id"] = number;
    page.send(command);
  }
  done(page, 3);
  std::vector<int> openings, skipped, all;
  std::vector<std::string> opened;
  for (const Json& event : page.events()) {
    if (event.at("event") == "opening") openings.push_back(event.at("number"));
    if (event.at("event") == "opened") opened.push_back(event.at("program"));
    if (event.at("event") == "error") skipped.push_back(event.at("id"));
  }
  EXPECT_THAT(openings, ::testing::AnyOf(::testing::ElementsAre(3), ::testing::ElementsAre(1, 3)));
  EXPECT_EQ(opened.size(), openings.size());
  EXPECT_EQ(opened.back(), "mine");
  std::ranges::merge(openings, skipped, std::back_inserter(all));
  EXPECT_THAT(all, ::testing::ElementsAre(1, 2, 3));
}

TEST_F(LabSession, RendersAProgramThatIsNotSavedAndLeavesNoFiles) {
  const LabProcess server = start();
  const auto unsaved = [](pid_t worker) {
    const std::string prefix = "quintet-lab-" + std::to_string(worker) + "-";
    return std::ranges::count_if(
        fs::directory_iterator(fs::temp_directory_path()),
        [&](const fs::directory_entry& entry) { return entry.path().filename().string().starts_with(prefix); });
  };
  PageClient page(server);
  page.send({{"do", "open"}, {"files", {{"a.rt.glsl", kPlain}}}, {"samples", 2}, {"id", 1}});
  EXPECT_THAT(colorOf(page.waitForImage(isLossless)), ::testing::ElementsAre(0, 255, 0));
  ASSERT_EQ(server.workers().size(), 1u);
  const pid_t worker = server.workers().front();
  EXPECT_EQ(unsaved(worker), 1);
  page.close();
  for (int i = 0; i < 250 && unsaved(worker) > 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(unsaved(worker), 0);
}

TEST_F(LabSession, SurvivesAnEndlessShader) {
  const LabProcess server = start({"--timeout", "2"});
  PageClient page(server), other(server);
  page.send(open());
  other.send(open());
  page.waitForImage(isLossless);
  other.waitForImage(isLossless);
  fs::create_directory(folder_ / "loop");
  writeFile(folder_ / "loop/loop.rt.glsl", endless());
  page.send(open("loop"));
  const Json hung = page.waitForWorker("hung");
  EXPECT_THAT(hung.at("message").get<std::string>(), HasSubstr("2 s"));
  EXPECT_EQ(page.waitForWorker("waiting").at("restarts"), 1);
  // The others work on.
  other.send({{"do", "exposure"}, {"stops", -1}, {"id", 2}});
  done(other, 2);
  EXPECT_EQ(server.request("GET", "/api/files").status, 200u);
  // A correction starts it again, however early it comes.
  writeFile(folder_ / "loop/loop.rt.glsl", kPlain);
  EXPECT_THAT(colorOf(page.waitForImage(isLossless)), ::testing::ElementsAre(0, 255, 0));
}

// Sets an environment variable, or removes it, while it exists.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const std::optional<std::string>& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~ScopedVariable() { set(before_); }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  void set(const std::optional<std::string>& value) const {
    if (value)
      ::setenv(name_, value->c_str(), 1);
    else
      ::unsetenv(name_);
  }

  const char* const name_;
  std::optional<std::string> before_;
};

// The environment of a process: NAME=VALUE.
std::vector<std::string> environmentOf(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/environ");
  std::vector<std::string> variables;
  for (std::string variable; std::getline(file, variable, '\0');) variables.push_back(variable);
  return variables;
}

TEST_F(LabSession, DriversOfCpusCompileFastUnlessTheUserDecides) {
  using ::testing::Contains;
  const auto workerOf = [&](const std::optional<std::string>& value) {
    const ScopedVariable variable("GALLIVM_PERF", value);
    const LabProcess server = start();
    PageClient page(server);
    page.send(open());
    page.waitFor("opened");
    EXPECT_EQ(server.workers().size(), 1u);
    return environmentOf(server.workers().front());
  };
  EXPECT_THAT(workerOf({}), Contains("GALLIVM_PERF=nopt").Times(1));
  EXPECT_THAT(workerOf(""), Contains("GALLIVM_PERF=").Times(1));
  EXPECT_THAT(workerOf("no_quad_lod"), ::testing::AllOf(Contains("GALLIVM_PERF=no_quad_lod").Times(1),
                                                        ::testing::Not(Contains("GALLIVM_PERF=nopt"))));
}

TEST_F(LabSession, RestartsAKilledWorker) {
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  page.waitForImage(isLossless);
  page.send({{"do", "set"}, {"parameter", "shade"}, {"value", {1, 1, 0}}, {"id", 2}});
  done(page, 2);
  page.waitFor("state");
  ASSERT_EQ(server.workers().size(), 1u);
  ::kill(server.workers().front(), SIGKILL);
  EXPECT_THAT(page.waitForWorker("crashed").at("message").get<std::string>(), HasSubstr("signal 9"));
  page.waitForWorker("started");
  EXPECT_THAT(colorOf(page.waitForImage(isLossless)), ::testing::ElementsAre(255, 255, 0));
  EXPECT_EQ(server.workers().size(), 1u);
}

TEST_F(LabSession, WaitsForASaveAfterTwoCrashesInSequence) {
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  page.waitForImage(isLossless);
  page.send({{"do", "set"}, {"parameter", "shade"}, {"value", {1, 1, 0}}, {"id", 2}});
  done(page, 2);
  ASSERT_EQ(server.workers().size(), 1u);
  ::kill(server.workers().front(), SIGSEGV);
  EXPECT_THAT(page.waitForWorker("crashed").at("message").get<std::string>(), HasSubstr("signal 11"));
  page.waitForWorker("started");
  EXPECT_THAT(colorOf(page.waitForImage(isLossless)), ::testing::ElementsAre(0, 255, 0));  // the default
  ASSERT_EQ(server.workers().size(), 1u);
  ::kill(server.workers().front(), SIGSEGV);
  page.waitForWorker("crashed");
  EXPECT_EQ(page.waitForWorker("waiting").at("restarts"), 2);
  save(replaced(kPlain, "\"0.0, 1.0, 0.0\"", "\"0.0, 0.0, 1.0\""));
  EXPECT_THAT(colorOf(page.waitForImage(isLossless)), ::testing::ElementsAre(0, 0, 255));
}

TEST_F(LabSession, EndsAnIdleWorkerAndStartsItAgain) {
  const LabProcess server = start({"--idle", "2"});
  PageClient page(server);
  page.send(open());
  page.waitForImage(isLossless);
  page.waitForWorker("idle");
  for (int i = 0; i < 100 && !server.workers().empty(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(server.workers().empty());
  page.send({{"do", "size"}, {"width", 32}, {"height", 32}});
  page.waitForWorker("started");
  page.waitForImage([](const lab::ImageHeader& header) { return header.size == uvec2(32, 32) && isLossless(header); });
}

TEST_F(LabSession, RejectsMessagesThatAreNoCommands) {
  const LabProcess server = start();
  PageClient text(server);
  text.sendText("hello");
  EXPECT_EQ(text.waitForClose(), 1008u);
  PageClient large(server);
  large.sendText(Json{{"do", "open"}, {"program", std::string((1u << 20) + 1, 'x')}}.dump());
  EXPECT_EQ(large.waitForClose(), 1009u);
}

TEST_F(LabSession, RejectsMoreSessionsThanTheLimit) {
  const LabProcess server = start({"--sessions", "2"});
  PageClient first(server), second(server), third(server);
  EXPECT_EQ(third.waitForClose(), 1013u);
  first.send(open());
  first.waitFor("opened");
}

TEST_F(LabSession, LeavesNothingAfterFiftySessions) {
  const LabProcess server = start();
  std::size_t memory = 0;
  for (int i = 0; i < 50; ++i) {
    PageClient page(server);
    page.waitForWorker("started");
    if (i % 10 == 0) {  // some of them render
      page.send(open());
      page.waitForImage();
    }
    if (i % 2 == 0) page.close();  // the others only end
    if (i == 9) memory = server.memory();
  }
  for (int i = 0; i < 500 && !server.workers().empty(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(server.workers().empty());
  EXPECT_LT(server.memory(), memory + (std::size_t{4} << 20));
}

TEST_F(LabSession, EndsWithTheServer) {
  LabProcess server = start();
  PageClient page(server);
  page.send(open());
  page.waitForImage();
  const std::vector<pid_t> workers = server.workers();
  ASSERT_EQ(workers.size(), 1u);
  EXPECT_EQ(server.stop(), 0);
  EXPECT_EQ(page.waitForClose(), 1001u);
  for (int i = 0; i < 250 && ::kill(workers.front(), 0) == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_NE(::kill(workers.front(), 0), 0);
}

}  // namespace
}  // namespace quintet::test
