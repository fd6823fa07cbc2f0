// SPDX-License-Identifier: Apache-2.0
#include "viewer/display.h"

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#include <gtest/gtest.h>

#include "io/color.h"
#include "render/tone_map/false_color.h"
#include "viewer/display_thread.h"
#include "viewer/histogram.h"

namespace quintet::viewer {
namespace {

// Linear RGBA floats.
io::Image makeImage(std::uint32_t width, std::uint32_t height, const std::vector<vec4>& pixels) {
  io::Image image = io::makeImage(width, height, 4, io::PixelType::f32, io::ColorEncoding::linear);
  image.premultiplied = true;
  for (std::size_t i = 0; i < pixels.size(); ++i)
    for (std::size_t c = 0; c < 4; ++c) image.samples<float>()[4 * i + c] = pixels[i][static_cast<glm::length_t>(c)];
  return image;
}

std::vector<int> pixelOf(const DisplayPixels& pixels, std::size_t index) {
  std::vector<int> result;
  for (std::size_t c = 0; c < 4; ++c) result.push_back(std::to_integer<int>((*pixels.bytes)[4 * index + c]));
  return result;
}

std::vector<int> bytesOf(const vec3& color) {
  return {io::byteFromUnit(color.r), io::byteFromUnit(color.g), io::byteFromUnit(color.b), 255};
}

TEST(ViewerDisplay, MapsTonesWithExposure) {
  const io::Image image = makeImage(2, 1, {{0.5f, 0.25f, 0.0f, 1.0f}, {0.125f, 0.125f, 0.125f, 0.5f}});
  DisplaySettings settings;
  settings.exposure = 1;
  const Display display = makeDisplay(image, nullptr, settings);
  EXPECT_EQ(display.image.size, uvec2(2, 1));
  EXPECT_EQ(pixelOf(display.image, 0), (std::vector<int>{255, 188, 0, 255}));
  EXPECT_EQ(pixelOf(display.image, 1), (std::vector<int>{188, 188, 188, 128})) << "straight alpha";
  EXPECT_FALSE(display.error);
}

TEST(ViewerDisplay, MarksPixelsThatAreNotFinite) {
  const io::Image image =
      makeImage(3, 2, {vec4(0.5f), {NAN, 0, 0, 1}, vec4(0.0f), {0, INFINITY, 0, 1}, vec4(1.0f), {1, 1, 1, NAN}});
  DisplaySettings settings;
  const Display display = makeDisplay(image, nullptr, settings);
  EXPECT_EQ(display.histogram.notFinitePixels, 2u);
  EXPECT_EQ(display.notFinite, (std::vector<uvec2>{{1, 0}, {0, 1}}));
  const std::vector<int> magenta{255, 0, 255, 255};
  EXPECT_EQ(pixelOf(display.image, 1), magenta);
  EXPECT_EQ(pixelOf(display.image, 3), magenta);
  EXPECT_NE(pixelOf(display.image, 2), magenta) << "black is a color";
  settings.marksNotFinite = false;
  EXPECT_NE(pixelOf(makeDisplay(image, nullptr, settings).image, 1), magenta);
  settings.marksNotFinite = true;
  settings.compare = CompareMode::split;
  const io::Image reference = makeImage(6, 1, std::vector<vec4>(6, vec4(1.0f)));
  const Display split = makeDisplay(image, &reference, settings);
  EXPECT_EQ(pixelOf(split.image, 1), magenta);
  EXPECT_EQ(split.referenceSize, uvec2(6, 1)) << "before it was scaled";
}

TEST(ViewerDisplay, ShowsAChannelInFalseColor) {
  const io::Image image = makeImage(2, 1, {{0.5f, 2.0f, 0.0f, 1.0f}, {NAN, 0.0f, 0.0f, 1.0f}});
  DisplaySettings settings;
  settings.falseColor = true;
  settings.range = {0.0, 4.0, false};
  settings.channel = Channel::green;
  EXPECT_EQ(pixelOf(makeDisplay(image, nullptr, settings).image, 0), bytesOf(falseColor(0.5)));
  settings.channel = Channel::luminance;
  const Display display = makeDisplay(image, nullptr, settings);
  EXPECT_EQ(pixelOf(display.image, 0), bytesOf(falseColor((0.2126 * 0.5 + 0.7152 * 2.0) / 4.0)));
  EXPECT_EQ(pixelOf(display.image, 1), (std::vector<int>{255, 0, 255, 255})) << "NaN";
}

TEST(ViewerDisplay, ShowsHeatAsAPngDoes) {
  const io::Image image = makeImage(3, 1, {{40, 0, 0, 1}, {20, 0, 0, 1}, {INFINITY, 0, 0, 1}});
  DisplaySettings settings;
  settings.heat = true;
  const Display display = makeDisplay(image, nullptr, settings);
  const io::Image expected = render::falseColor(image, {render::falseColorScale(image, 0.0f), /*legend=*/false});
  for (std::size_t i = 0; i < 3; ++i) {
    const auto* rgb = expected.samples<std::uint8_t>().data() + 3 * i;
    EXPECT_EQ(pixelOf(display.image, i), (std::vector<int>{rgb[0], rgb[1], rgb[2], 255})) << i;
  }
  EXPECT_EQ(pixelOf(display.image, 1), bytesOf(falseColor(0.5)));
  ASSERT_TRUE(display.heatRange);
  EXPECT_EQ(display.heatRange->most, 40.0);
  settings.exposure = 1;
  EXPECT_EQ(makeDisplay(image, nullptr, settings).heatRange->most, 20.0);
  settings.falseColor = true;
  EXPECT_FALSE(makeDisplay(image, nullptr, settings).heatRange) << "the user has chosen a range";
}

TEST(ViewerDisplay, ComparesWithAReference) {
  const io::Image image = makeImage(2, 1, {{0.5f, 0.5f, 0.5f, 1.0f}, {0.0f, 0.25f, 0.0f, 1.0f}});
  const io::Image reference = makeImage(2, 1, {{0.5f, 0.5f, 0.5f, 1.0f}, {0.0f, 0.0f, 0.0f, 1.0f}});
  DisplaySettings settings;
  settings.range.most = 0.5;
  settings.compare = CompareMode::difference;
  const Display difference = makeDisplay(image, &reference, settings);
  EXPECT_EQ(pixelOf(difference.image, 0), bytesOf(falseColor(0.0)));
  EXPECT_EQ(pixelOf(difference.image, 1), bytesOf(falseColor(0.5)));
  EXPECT_DOUBLE_EQ(difference.error.value(), 0.125);

  settings.compare = CompareMode::split;
  const Display split = makeDisplay(image, &reference, settings);
  EXPECT_EQ(pixelOf(split.reference, 1), (std::vector<int>{0, 0, 0, 255}));
  EXPECT_EQ(split.reference.size, split.image.size);

  settings.compare = CompareMode::flip;
  EXPECT_GT(makeDisplay(image, &reference, settings).error.value(), 0.01);
  EXPECT_LT(makeDisplay(image, &image, settings).error.value(), 1e-6);
}

TEST(ViewerDisplay, ResizesTheReference) {
  const io::Image image = makeImage(1, 1, {{0.5f, 0.5f, 0.5f, 1.0f}});
  const io::Image reference =
      makeImage(2, 2, {{0, 0, 0, 1}, {1, 1, 1, 1}, {0.25f, 0.25f, 0.25f, 1}, {0.75f, 0.75f, 0.75f, 1}});
  DisplaySettings settings;
  settings.compare = CompareMode::difference;
  EXPECT_NEAR(makeDisplay(image, &reference, settings).error.value(), 0.0, 1e-6)
      << "the mean of the four pixels is 0.5";
}

// A reference of 2x2 pixels has half of the width of an image of 4x2 pixels.
TEST(ViewerDisplay, KeepsTheAspectRatioOfTheReference) {
  const io::Image image = makeImage(4, 2, std::vector<vec4>(8, vec4(0.5f, 0.5f, 0.5f, 1.0f)));
  const io::Image reference = makeImage(2, 2, {{0, 0, 0, 1}, {1, 1, 1, 1}, {0, 0, 0, 1}, {1, 1, 1, 1}});
  DisplaySettings settings;
  settings.compare = CompareMode::split;
  const DisplayPixels shown = makeDisplay(image, &reference, settings).reference;
  EXPECT_EQ(shown.size, uvec2(4, 2));
  EXPECT_EQ(pixelOf(shown, 0)[3], 0) << "beside the reference";
  EXPECT_EQ(pixelOf(shown, 1), (std::vector<int>{0, 0, 0, 255}));
  EXPECT_EQ(pixelOf(shown, 6), (std::vector<int>{255, 255, 255, 255}));
  EXPECT_EQ(pixelOf(shown, 7)[3], 0);
  settings.compare = CompareMode::difference;
  settings.range.most = 1.0;
  const Display difference = makeDisplay(image, &reference, settings);
  EXPECT_EQ(pixelOf(difference.image, 0), bytesOf(falseColor(0.0)));
  EXPECT_EQ(pixelOf(difference.image, 1), bytesOf(falseColor(0.5)));
  EXPECT_DOUBLE_EQ(difference.error.value(), 0.5) << "of the four pixels of the reference";
}

TEST(ViewerDisplay, IgnoresComparisonsWithoutAReference) {
  const io::Image image = makeImage(1, 1, {{1, 1, 1, 1}});
  DisplaySettings settings;
  settings.compare = CompareMode::flip;
  EXPECT_EQ(pixelOf(makeDisplay(image, nullptr, settings).image, 0), (std::vector<int>{255, 255, 255, 255}));
}

TEST(Histogram, CountsPixelsPerStop) {
  const float inf = std::numeric_limits<float>::infinity();
  const io::Image image = makeImage(4, 1, {{1, 2, 0, 1}, {1e-9f, 1e9f, 1, 1}, {inf, 0, 0, 1}, {0.5f, 0.5f, 0.5f, 1}});
  const Histogram histogram = makeHistogram(image);
  const auto binOf = [](double stop) {
    return static_cast<std::size_t>((stop - Histogram::kFirstStop) / Histogram::kStopsPerBin);
  };
  EXPECT_EQ(histogram.notFinitePixels, 1u);
  EXPECT_EQ(histogram.channels[0][binOf(0.0)], 1u);
  EXPECT_EQ(histogram.channels[1][binOf(1.0)], 1u);
  EXPECT_EQ(histogram.channels[2][0], 1u) << "black";
  EXPECT_EQ(histogram.channels[0][0], 1u) << "too dark";
  EXPECT_EQ(histogram.channels[1][kHistogramBins - 1], 1u) << "too bright";
  std::uint32_t total = 0;
  for (const std::uint32_t count : histogram.luminance) total += count;
  EXPECT_EQ(total, 3u);
  EXPECT_DOUBLE_EQ(histogram.least, 0.5);
  EXPECT_NEAR(histogram.mean, (0.2126 + 2 * 0.7152 + 0.7152e9 + 0.0722 + 0.5) / 3.0, 100.0);
}

TEST(Histogram, IsEmptyWithoutFinitePixels) {
  const Histogram histogram = makeHistogram(makeImage(1, 1, {{NAN, 0, 0, 1}}));
  EXPECT_EQ(histogram.least, 0.0);
  EXPECT_EQ(histogram.most, 0.0);
  EXPECT_EQ(histogram.notFinitePixels, 1u);
}

TEST(DisplayThread, MakesTheLatestDisplay) {
  std::mutex mutex;
  std::condition_variable changed;
  int calls = 0;
  DisplayThread thread([&] {
    const std::lock_guard lock(mutex);
    ++calls;
    changed.notify_one();
  });
  EXPECT_EQ(thread.latest(), nullptr);
  const auto show = [&](float value) {
    DisplayRequest request;
    request.image = std::make_shared<io::Image>(makeImage(1, 1, {{value, value, value, 1.0f}}));
    thread.request(request);
  };
  thread.request({});  // nothing to show
  show(0.0f);
  show(1.0f);
  std::unique_lock lock(mutex);
  const bool shown = changed.wait_for(lock, std::chrono::seconds(60), [&] {
    const auto latest = thread.latest();
    return latest && pixelOf(latest->image, 0).front() == 255;
  });
  EXPECT_TRUE(shown);
  EXPECT_GE(calls, 1);
  EXPECT_EQ(thread.error(), "");
}

}  // namespace
}  // namespace quintet::viewer
