// SPDX-License-Identifier: Apache-2.0
// The limit on the memory that an image file requests.
#include <gmock/gmock.h>
#include <turbojpeg.h>

#include <cstring>
#include <fstream>

#include "base/error.h"
#include "base/memory_budget.h"
#include "io/codec.h"
#include "io/exr/exr.h"
#include "io/ktx2_builder.h"
#include "io/samples.h"
#include "temp_folder.h"

namespace quintet::io {
namespace {

using test::Bytes;

constexpr std::size_t kLimit = std::size_t{1} << 20;

// An OpenEXR file of 4 x 4 pixels whose header states a window of 65536 x 4 pixels, 3 MiB. Four rows are one chunk.
Bytes wideExr(std::string_view window) {
  Bytes bytes = encodeExr(test::makeGradient(4, 4, 3, PixelType::f32));
  const std::string attribute = std::string(window) + std::string("\0box2i\0", 7);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t at = text.find(attribute);
  EXPECT_NE(at, text.npos);
  constexpr std::int32_t kLast = 65535;
  std::memcpy(bytes.data() + at + attribute.size() + 4 + 8, &kLast, sizeof kLast);
  return bytes;
}

// Each header states more pixels than the bytes have, and more than the limit allows.
std::vector<std::pair<std::string, Bytes>> lyingHeaders() {
  test::Ktx2 ktx2{.width = 4096, .height = 4096, .scheme = 2, .level = Bytes(16), .statedSize = std::uint64_t{1} << 26};
  Bytes webp = test::encodeWebp(test::makeGradient(16, 16, 3, PixelType::u8), -1.0f);
  std::uint32_t sides = 0;  // 14 bits each, minus 1 (WebP Lossless, section 3)
  std::memcpy(&sides, webp.data() + 21, sizeof sides);
  sides |= 0x0FFFFFFF;
  std::memcpy(webp.data() + 21, &sides, sizeof sides);
  Bytes jpeg = test::encodeJpeg(test::makeGradient(64, 64, 3, PixelType::u8), 90, TJSAMP_444, 0);
  for (std::size_t at = 0; at + 9 < jpeg.size(); ++at)
    if (jpeg[at] == std::byte{0xFF} && jpeg[at + 1] == std::byte{0xC0}) {
      jpeg[at + 5] = std::byte{2}, jpeg[at + 7] = std::byte{3};  // 832 x 576 pixels, 1.4 MiB
      break;
    }
  return {{"hdr", test::bytesOf("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 4096\n")},
          {"display window", wideExr("displayWindow")},
          {"data window", wideExr("dataWindow")},
          {"ktx2", ktx2.build()},
          {"webp", webp},
          {"jpeg", jpeg}};
}

TEST(ImageMemory, CountsWhatHeadersState) {
  const quintet::test::TempFolder folder;
  for (const auto& [name, bytes] : lyingHeaders()) {
    MemoryBudget ofBytes(name, kLimit), ofFile(name, kLimit), ofRadiance(name, kLimit);
    EXPECT_THROW(decodeImage(bytes, name, ofBytes), MemoryError) << name;
    std::ofstream(folder / "image", std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    EXPECT_THROW(readImage(folder / "image", ofFile), MemoryError) << name;
    EXPECT_THROW(readRadiance(folder / "image", ofRadiance), MemoryError) << name;
  }
  for (const char* window : {"displayWindow", "dataWindow"}) {
    MemoryBudget budget("layer", kLimit);
    EXPECT_THROW(decodeExrLayer(wideExr(window), "layer", "beauty", budget), MemoryError) << window;
    EXPECT_THROW(decodeExr(wideExr(window), "channels", budget), MemoryError) << window;
  }
}

// What remains in the budget is the decoded image alone.
TEST(ImageMemory, GivesBackWhatDecodingNeeds) {
  constexpr std::size_t kEnough = std::size_t{64} << 20;  // also for the tables of Basis Universal
  const quintet::test::TempFolder folder;
  for (const test::Sample& sample : test::allSamples()) {
    std::ofstream(folder / "image", std::ios::binary)
        .write(reinterpret_cast<const char*>(sample.bytes.data()), static_cast<std::streamsize>(sample.bytes.size()));
    MemoryBudget budget("image", kEnough);
    const Image image = readImage(folder / "image", budget);
    EXPECT_NO_THROW(budget.take(kEnough - image.data.size() - 1)) << sample.name;  // 1: the end of the file
    EXPECT_THROW(budget.take(1), MemoryError) << sample.name;
  }
}

// The memory of a progressive file is that of the image and of its coefficients, which have two bytes.
TEST(ImageMemory, CountsTheCoefficientsOfProgressiveJpeg) {
  const Image image = test::makeGradient(64, 64, 3, PixelType::u8);
  const auto temporary = [&](int flags) {
    return probeImage(test::encodeJpeg(image, 90, TJSAMP_420, flags), "a.jpg").temporaryBytes;
  };
  EXPECT_EQ(temporary(0), 0u);
  EXPECT_EQ(temporary(TJFLAG_PROGRESSIVE), 2 * image.data.size());
}

TEST(ImageMemory, CountsFloatsOfEnvironments) {
  const quintet::test::TempFolder folder;
  writeImage(folder / "a.png", test::makeGradient(128, 128, 3, PixelType::u8));  // 48 KiB, as floats 192 KiB
  MemoryBudget enough("a.png", std::size_t{256} << 10), tooSmall("a.png", std::size_t{224} << 10);
  EXPECT_EQ(readRadiance(folder / "a.png", enough).type, PixelType::f32);
  EXPECT_THROW(readRadiance(folder / "a.png", tooSmall), MemoryError);
}

}  // namespace
}  // namespace quintet::io
