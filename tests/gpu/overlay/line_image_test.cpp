// SPDX-License-Identifier: Apache-2.0
// The lines that the device draws, pixel by pixel, against a rasterizer that follows the definitions of gpu::LineList.
#include "overlay/line_image.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness.h"

namespace quintet::overlay {
namespace {

constexpr uvec2 kLineImageSize{64, 48};

const WindowShaders& shaders() {
  static const WindowShaders shaders = compileLineShaders({});
  return shaders;
}

io::Image plainImage(std::uint32_t channels = 4) {
  io::Image image =
      io::makeImage(kLineImageSize.x, kLineImageSize.y, channels, io::PixelType::u8, io::ColorEncoding::sRgb);
  for (std::uint32_t y = 0; y < kLineImageSize.y; ++y)
    for (std::uint32_t x = 0; x < kLineImageSize.x; ++x) {
      const auto pixel = image.pixel<std::uint8_t>(x, y);
      for (std::uint32_t c = 0; c < channels; ++c)
        pixel[c] = static_cast<std::uint8_t>(c == 3 ? 255u : 40 + x + 50 * c);
    }
  return image;
}

// A surface at this reversed depth in the columns from `first` to `end`.
std::shared_ptr<std::vector<float>> wall(float depth, std::uint32_t first, std::uint32_t end,
                                         uvec2 size = kLineImageSize) {
  auto depths = std::make_shared<std::vector<float>>(std::size_t{size.x} * size.y, 0.0f);
  for (std::uint32_t y = 0; y < size.y; ++y)
    for (std::uint32_t x = first; x < end; ++x) (*depths)[y * size.x + x] = depth;
  return depths;
}

vec4 unpack(std::uint32_t color) {
  return vec4(color & 0xFF, color >> 8 & 0xFF, color >> 16 & 0xFF, color >> 24) / 255.0f;
}

float surfaceAt(const gpu::LineList& list, uvec2 size, const std::vector<float>& depths, vec2 point) {
  const auto column = static_cast<int>(std::floor((point.x - list.depthX) / list.depthScale));
  const auto row = static_cast<int>(std::floor((point.y - list.depthY) / list.depthScale));
  const auto isInside = [](int at, std::uint32_t count) { return at >= 0 && at < static_cast<int>(count); };
  if (!isInside(column, size.x) || !isInside(row, size.y)) return std::numeric_limits<float>::lowest();
  float least = 1e30f;
  for (const auto& [dx, dy] : std::vector<std::pair<int, int>>{{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    const int x = std::clamp(column + dx, 0, static_cast<int>(size.x) - 1);
    const int y = std::clamp(row + dy, 0, static_cast<int>(size.y) - 1);
    least = std::min(least, depths[static_cast<std::size_t>(y) * size.x + static_cast<std::size_t>(x)]);
  }
  return least;
}

// Opacity of a line at the center of a pixel.
float opacityAt(const gpu::LineList& list, const gpu::Line& line, float radius, vec2 at, uvec2 depthSize,
                const std::vector<float>& depths) {
  const vec2 a(line.ax, line.ay), b(line.bx, line.by);
  const float length = glm::length(b - a);
  const float t = length > 0 ? std::clamp(glm::dot(at - a, b - a) / (length * length), 0.0f, 1.0f) : 0.0f;
  const vec2 center = glm::mix(a, b, t);
  float opacity = std::clamp(radius + 0.5f - glm::length(at - center), 0.0f, 1.0f);
  opacity *= glm::mix(line.opacityA, line.opacityB, t);
  const float surface = surfaceAt(list, depthSize, depths, center);
  if (glm::mix(line.depthA, line.depthB, t) >= surface - list.relativeBias * std::abs(surface) - list.bias)
    return opacity;
  opacity *= list.hiddenOpacity;
  if (list.dash <= 0 || length == 0) return opacity;
  // Gaps and dashes with the length `dash`; the first gap has half of it.
  const float phase = std::fmod(t * length, 2.0f * list.dash);
  const float fromEdge = std::min(phase - 0.5f * list.dash, 1.5f * list.dash - phase);
  return opacity * std::clamp(0.5f + fromEdge, 0.0f, 1.0f);
}

io::Image expectedImage(const gpu::LineList& list, uvec2 depthSize, const std::vector<float>& depths) {
  io::Image image = plainImage();
  for (std::uint32_t y = 0; y < kLineImageSize.y; ++y)
    for (std::uint32_t x = 0; x < kLineImageSize.x; ++x) {
      const auto pixel = image.pixel<std::uint8_t>(x, y);
      vec3 color = vec3(pixel[0], pixel[1], pixel[2]) / 255.0f;
      for (const bool outline : {true, false})
        for (const gpu::Line& line : list.lines) {
          const vec4 source = unpack(outline ? line.outlineColor : line.color);
          const float radius = 0.5f * line.width + (outline ? line.outline : 0.0f);
          const vec2 at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
          const float alpha = source.a * opacityAt(list, line, radius, at, depthSize, depths);
          color = glm::mix(color, vec3(source), alpha);
        }
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(std::lround(255.0f * color[c]));
    }
  return image;
}

void expectEqual(const io::Image& image, const io::Image& expected) {
  ASSERT_EQ(image.data.size(), expected.data.size());
  int wrong = 0;
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        const int actual = image.pixel<std::uint8_t>(x, y)[c], wanted = expected.pixel<std::uint8_t>(x, y)[c];
        // Each blended line is rounded to a byte.
        if (std::abs(actual - wanted) > 4 && ++wrong <= 5)
          ADD_FAILURE() << "pixel " << x << "," << y << " channel " << c << ": " << actual << ", expected " << wanted;
      }
  EXPECT_EQ(wrong, 0);
}

gpu::Line makeLine(vec2 a, vec2 b, float depthA, float depthB, std::uint32_t color) {
  gpu::Line line;
  line.ax = a.x, line.ay = a.y, line.bx = b.x, line.by = b.y;
  line.depthA = depthA, line.depthB = depthB;
  line.color = color;
  return line;
}

TEST(LineImage, AgreesWithARasterizerOnTheHost) {
  gpu::LineList list;
  list.relativeBias = 0.01f;
  list.lines = {makeLine({4.3f, 6.2f}, {60.1f, 9.7f}, 0.5f, 0.5f, 0xFF00FF00),     // behind the wall in the middle
                makeLine({4.0f, 16.0f}, {60.0f, 16.0f}, 2.0f, 2.0f, 0xFF0000FF),   // before it
                makeLine({10.0f, 22.0f}, {55.5f, 45.0f}, 2.0f, 0.2f, 0xFFFF8000),  // goes behind it
                makeLine({8.0f, 40.0f}, {8.0f, 40.0f}, 1.0f, 1.0f, 0xFFFFFFFF),    // disks
                makeLine({32.5f, 28.0f}, {32.5f, 28.0f}, 0.1f, 0.1f, 0xC0FFFFFF),
                makeLine({-30.0f, 30.0f}, {20.0f, 80.0f}, 1.0f, 1.0f, 0xFF404080)};  // leaves the image
  list.lines[1].opacityB = 0.0f;
  list.lines[2].width = 5.0f;
  list.lines[2].outline = 2.0f;
  list.lines[2].outlineColor = 0x80FFFFFF;
  list.lines[3].width = list.lines[4].width = 7.0f;
  const auto depths = wall(1.0f, 20, 44);
  expectEqual(drawLines(test::testContext(), shaders(), plainImage(), list, kLineImageSize, depths),
              expectedImage(list, kLineImageSize, *depths));
  // Depths with a lower resolution, which begin elsewhere.
  list.depthX = -8.0f;
  list.depthY = 8.0f;  // the first line is partly above them
  list.depthScale = 4.0f;
  list.dash = 0.0f;
  list.bias = 0.05f;
  const uvec2 small{20, 12};
  const auto coarse = wall(0.52f, 6, 15, small);
  expectEqual(drawLines(test::testContext(), shaders(), plainImage(), list, small, coarse),
              expectedImage(list, small, *coarse));
}

TEST(LineImage, HidesNothingWithoutDepths) {
  gpu::LineList list;
  list.lines = {makeLine({4, 20.5f}, {60, 20.5f}, 1e-6f, 1e-6f, 0xFF00FF00)};
  const io::Image image = drawLines(test::testContext(), shaders(), plainImage(), list, {}, nullptr);
  for (const std::uint32_t x : {6u, 13u, 30u, 58u}) {
    const auto pixel = image.pixel<std::uint8_t>(x, 20);
    EXPECT_EQ(pixel[0], 0);
    EXPECT_EQ(pixel[1], 255);
  }
}

TEST(LineImage, KeepsTheImageWithoutLines) {
  const io::Image image =
      drawLines(test::testContext(), shaders(), plainImage(3), {}, kLineImageSize, wall(1.0f, 0, 10));
  EXPECT_EQ(image.channels, 3u);
  EXPECT_EQ(image.data, plainImage(3).data);
}

}  // namespace
}  // namespace quintet::overlay
