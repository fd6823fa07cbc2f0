// SPDX-License-Identifier: Apache-2.0
// Images for terminals: the bytes of tiny images, and larger images decoded as a terminal does it.
#include "io/terminal_image.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace quintet::io {
namespace {

Image rgb(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& values) {
  Image image = makeImage(width, height, 3, PixelType::u8, ColorEncoding::sRgb);
  std::ranges::copy(values, image.samples<std::uint8_t>().begin());
  return image;
}

// Smooth colors, as in a render.
Image gradient(std::uint32_t width, std::uint32_t height) {
  Image image = makeImage(width, height, 3, PixelType::u8, ColorEncoding::sRgb);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const auto pixel = image.pixel<std::uint8_t>(x, y);
      pixel[0] = static_cast<std::uint8_t>(255 * x / (width - 1));
      pixel[1] = static_cast<std::uint8_t>(255 * y / (height - 1));
      pixel[2] = static_cast<std::uint8_t>(255 - 128 * (x + y) / (width + height));
    }
  return image;
}

// ---- kitty

TEST(Kitty, OnePixel) {
  EXPECT_EQ(encodeKitty(rgb(1, 1, {1, 2, 3}), 7), "\x1b_Ga=T,q=2,f=24,s=1,v=1,i=7,p=1,C=1,m=0;AQID\x1b\\");
  EXPECT_EQ(deleteKitty(7), "\x1b_Ga=d,d=I,i=7,q=2\x1b\\");
}

std::vector<std::uint8_t> fromBase64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(kDigits.find(c));
    if ((count += 6) >= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> (count -= 8)));
  }
  return bytes;
}

TEST(Kitty, ChunksDecodeToTheImage) {
  const Image image = gradient(61, 47);  // 8601 bytes: three chunks
  const std::string encoded = encodeKitty(image, 3);
  std::string_view text = encoded;
  std::vector<std::uint8_t> bytes;
  std::vector<std::string> controls;
  while (!text.empty()) {
    ASSERT_TRUE(text.starts_with("\x1b_G"));
    const std::size_t semicolon = text.find(';'), end = text.find("\x1b\\");
    ASSERT_NE(end, text.npos);
    controls.emplace_back(text.substr(3, semicolon - 3));
    const std::string_view data = text.substr(semicolon + 1, end - semicolon - 1);
    EXPECT_LE(data.size(), 4096u);
    const std::vector<std::uint8_t> part = fromBase64(data);
    bytes.insert(bytes.end(), part.begin(), part.end());
    text.remove_prefix(end + 2);
  }
  EXPECT_THAT(controls, testing::ElementsAre("a=T,q=2,f=24,s=61,v=47,i=3,p=1,C=1,m=1", "m=1", "m=0"));
  EXPECT_TRUE(std::ranges::equal(bytes, image.samples<std::uint8_t>()));
}

// ---- Sixel

// A decoder for what encodeSixel writes. Returns an empty image if a pixel is not set, or is set twice.
Image decodeSixel(std::string_view text) {
  const auto number = [&](std::size_t& at) {
    std::uint32_t value = 0;
    while (at < text.size() && text[at] >= '0' && text[at] <= '9')
      value = value * 10 + static_cast<std::uint32_t>(text[at++] - '0');
    return value;
  };
  std::size_t at = text.find("\"1;1;") + 5;
  const std::uint32_t width = number(at);
  const std::uint32_t height = number(++at);
  Image image = makeImage(width, height, 3, PixelType::u8, ColorEncoding::sRgb);
  std::vector<int> set(image.pixelCount());
  std::map<std::uint32_t, std::array<std::uint32_t, 3>> palette;
  std::uint32_t color = 0, x = 0, band = 0;
  const auto draw = [&](char sixel, std::uint32_t count) {
    const int bits = sixel - '?';
    for (; count > 0; --count, ++x)
      for (std::uint32_t row = 0; row < 6; ++row) {
        if (!(bits >> row & 1)) continue;
        if (x >= width || band + row >= height) return void(set.assign(1, 0));
        ++set[std::size_t{band + row} * width + x];
        for (std::size_t c = 0; c < 3; ++c)
          image.pixel<std::uint8_t>(x, band + row)[c] = static_cast<std::uint8_t>((palette[color][c] * 255 + 50) / 100);
      }
  };
  while (at < text.size() && text[at] != '\x1b') {
    const char c = text[at++];
    if (c == '#') {
      color = number(at);
      if (text[at] != ';') continue;
      at += 2;  // ";2"
      for (std::uint32_t& value : palette[color]) value = number(++at);
    } else if (c == '!') {
      const std::uint32_t count = number(at);
      draw(text[at++], count);
    } else if (c == '$' || c == '-') {
      x = 0;
      if (c == '-') band += 6;
    } else {
      draw(c, 1);
    }
  }
  const bool complete = std::ranges::all_of(set, [](int count) { return count == 1; }) && palette.size() <= 256;
  return complete ? image : Image{};
}

TEST(Sixel, TinyImages) {
  EXPECT_EQ(encodeSixel(rgb(1, 1, {255, 0, 0})),
            "\x1b"
            "7\x1bP0;1q\"1;1;1;1#0;2;100;0;0#0@\x1b\\\x1b"
            "8");
  // Black above white: bit 0 is the upper pixel.
  EXPECT_EQ(encodeSixel(rgb(1, 2, {0, 0, 0, 255, 255, 255})),
            "\x1b"
            "7\x1bP0;1q\"1;1;1;2#0;2;0;0;0#1;2;100;100;100#0@$#1A\x1b\\\x1b"
            "8");
  // Runs of four and more have a length, and a new band starts after six rows.
  EXPECT_EQ(encodeSixel(rgb(4, 7, std::vector<std::uint8_t>(84, 0))),
            "\x1b"
            "7\x1bP0;1q\"1;1;4;7#0;2;0;0;0#0!4~-#0!4@\x1b\\\x1b"
            "8");
}

TEST(Sixel, DecodesToTheImage) {
  const Image image = gradient(97, 50);
  const Image decoded = decodeSixel(encodeSixel(image));
  ASSERT_EQ(decoded.width, 97u);
  ASSERT_EQ(decoded.height, 50u);
  // Each pixel is near, and dithering keeps the mean of each block.
  for (std::uint32_t y = 0; y + 10 <= 50; y += 10)
    for (std::uint32_t x = 0; x + 10 <= 97; x += 10)
      for (std::size_t c = 0; c < 3; ++c) {
        double difference = 0;
        for (std::uint32_t i = 0; i < 100; ++i) {
          const int one = decoded.pixel<std::uint8_t>(x + i % 10, y + i / 10)[c] -
                          image.pixel<std::uint8_t>(x + i % 10, y + i / 10)[c];
          EXPECT_LE(std::abs(one), 64);
          difference += one;
        }
        EXPECT_LE(std::abs(difference / 100), 4.0) << x << ", " << y;
      }
}

TEST(Sixel, KeepsUpTo256DistinctColors) {
  // Multiples of 51 are whole percents, in different cells of the histogram.
  Image image = makeImage(36, 6, 3, PixelType::u8, ColorEncoding::sRgb);
  for (std::uint32_t i = 0; i < 216; ++i) {
    const auto pixel = image.pixel<std::uint8_t>(i % 36, i / 36);
    for (std::uint32_t c = 0, rest = i; c < 3; ++c, rest /= 6) pixel[c] = static_cast<std::uint8_t>(rest % 6 * 51);
  }
  const Image decoded = decodeSixel(encodeSixel(image));
  ASSERT_FALSE(decoded.empty());
  EXPECT_EQ(decoded.data, image.data);
}

// ---- Half blocks

TEST(HalfBlocks, TinyImages) {
  EXPECT_EQ(encodeHalfBlocks(rgb(1, 2, {1, 2, 3, 4, 5, 6}), true), "\x1b[38;2;1;2;3m\x1b[48;2;4;5;6m\u2580\x1b[0m\r\n");
  // Colors that stay are not repeated. The last row of an odd height has no lower pixel.
  EXPECT_EQ(encodeHalfBlocks(rgb(2, 1, {9, 9, 9, 9, 9, 9}), true), "\x1b[38;2;9;9;9m\u2580\u2580\x1b[0m\r\n");
}

TEST(HalfBlocks, NearestColorsOfThePalette) {
  const auto indexOf = [](std::uint8_t r, std::uint8_t g, std::uint8_t b) {
    return encodeHalfBlocks(rgb(1, 1, {r, g, b}), false);
  };
  EXPECT_EQ(indexOf(0, 0, 0), "\x1b[38;5;16m\u2580\x1b[0m\r\n");
  EXPECT_EQ(indexOf(255, 0, 0), "\x1b[38;5;196m\u2580\x1b[0m\r\n");
  EXPECT_EQ(indexOf(255, 255, 255), "\x1b[38;5;231m\u2580\x1b[0m\r\n");
  EXPECT_EQ(indexOf(128, 128, 128), "\x1b[38;5;244m\u2580\x1b[0m\r\n") << "gray";
  EXPECT_EQ(indexOf(100, 0, 0), "\x1b[38;5;52m\u2580\x1b[0m\r\n") << "95, 0, 0";
}

// ---- Sizes

TEST(FitToTerminal, KeepsTheAspectRatio) {
  const TerminalArea area{80, 22, 10, 20};
  // 800x440 pixels of space.
  EXPECT_EQ(fitToTerminal(1280, 720, area, TerminalProtocol::sixel).width, 782u);
  EXPECT_EQ(fitToTerminal(1280, 720, area, TerminalProtocol::sixel).height, 440u);
  EXPECT_EQ(fitToTerminal(1280, 720, area, TerminalProtocol::kitty).rows, 22u);
  EXPECT_EQ(fitToTerminal(1280, 320, area, TerminalProtocol::kitty).height, 200u);
  EXPECT_EQ(fitToTerminal(1280, 320, area, TerminalProtocol::kitty).rows, 10u);
  const TerminalFit blocks = fitToTerminal(1280, 720, area, TerminalProtocol::halfBlocks);
  EXPECT_EQ(blocks.width, 78u);
  EXPECT_EQ(blocks.height, 44u);
  EXPECT_EQ(blocks.rows, 22u);
  // Cells that are three times as high as wide: pixels are higher than wide, so there are fewer of them.
  const TerminalFit high = fitToTerminal(60, 60, {80, 22, 10, 30}, TerminalProtocol::halfBlocks);
  EXPECT_EQ(high.width, 60u);
  EXPECT_EQ(high.height, 40u);
}

TEST(FitToTerminal, DoesNotEnlarge) {
  for (const TerminalProtocol protocol :
       {TerminalProtocol::kitty, TerminalProtocol::sixel, TerminalProtocol::halfBlocks}) {
    const TerminalFit fit = fitToTerminal(16, 9, {200, 60, 0, 0}, protocol);
    EXPECT_EQ(fit.width, 16u);
    EXPECT_EQ(fit.height, 9u);
    EXPECT_EQ(fit.rows, protocol == TerminalProtocol::halfBlocks ? 5u : 1u);
  }
}

TEST(FitToTerminal, HasAtLeastOnePixel) {
  const TerminalFit wide = fitToTerminal(60000, 1, {80, 22, 0, 0}, TerminalProtocol::halfBlocks);
  EXPECT_EQ(wide.width, 80u);
  EXPECT_EQ(wide.height, 1u);
  EXPECT_EQ(fitToTerminal(1, 60000, {1, 0, 0, 0}, TerminalProtocol::sixel).height, 12u);
}

}  // namespace
}  // namespace quintet::io
