// SPDX-License-Identifier: Apache-2.0
#include "io/codec.h"

#include <gmock/gmock.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/file.h"
#include "io/samples.h"
#include "temp_folder.h"

namespace quintet::io {
namespace {

using test::Bytes;
using test::makeGradient;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

std::string imageError(const Bytes& bytes, const std::string& name = "a.img") {
  try {
    decodeImage(bytes, name);
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

double meanDifference(const Image& a, const Image& b) {
  EXPECT_EQ(a.data.size(), b.data.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < a.sampleCount(); ++i)
    sum += std::abs(a.samples<std::uint8_t>()[i] - b.samples<std::uint8_t>()[i]);
  return sum / static_cast<double>(a.sampleCount());
}

std::string textOf(const Bytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

std::vector<int> bytesAsInts(const Image& image) {
  const auto samples = image.samples<std::uint8_t>();
  return {samples.begin(), samples.end()};
}

TEST(PngTest, RoundTripsEveryForm) {
  for (const PixelType type : {PixelType::u8, PixelType::u16}) {
    for (std::uint32_t channels = 1; channels <= 4; ++channels) {
      const Image image = makeGradient(37, 21, channels, type);
      const Image back = decodeImage(encodePng(image), "a.png");
      EXPECT_EQ(back.width, 37u);
      EXPECT_EQ(back.height, 21u);
      EXPECT_EQ(back.channels, channels);
      EXPECT_EQ(back.type, type);
      EXPECT_EQ(back.encoding, ColorEncoding::sRgb);
      EXPECT_TRUE(back.data == image.data) << channels;
    }
  }
}

TEST(PngTest, ExpandsPalettesAndBits) {
  test::PngParts parts{5, 2, 2, 3, 0, {{"PLTE", std::string("\1\2\3\4\5\6\7\x8\x9", 9)}}, {}};
  parts.rows = std::string("\0\x18\x40\0\x24\x80", 6);  // 0 1 2 0 1 / 0 2 1 0 2
  const Image rgb = decodeImage(test::makePng(parts), "a.png");
  EXPECT_EQ(rgb.channels, 3u);
  EXPECT_THAT(bytesAsInts(rgb), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2, 3, 4, 5, 6,  //
                                            1, 2, 3, 7, 8, 9, 4, 5, 6, 1, 2, 3, 7, 8, 9));
  parts.chunks.emplace_back("tRNS", "\x80");
  const Image rgba = decodeImage(test::makePng(parts), "a.png");
  EXPECT_EQ(rgba.channels, 4u);
  EXPECT_EQ(rgba.pixel<std::uint8_t>(0, 0)[3], 0x80);
  EXPECT_EQ(rgba.pixel<std::uint8_t>(1, 0)[3], 255);

  const Image gray = decodeImage(test::makePng({9, 1, 1, 0, 0, {}, std::string("\0\xa5\x80", 3)}), "a.png");
  EXPECT_EQ(gray.channels, 1u);
  EXPECT_THAT(bytesAsInts(gray), ElementsAre(255, 0, 255, 0, 0, 255, 0, 255, 255));
  const Image nibbles = decodeImage(test::makePng({2, 1, 4, 0, 0, {}, std::string("\0\x3f", 2)}), "a.png");
  EXPECT_THAT(bytesAsInts(nibbles), ElementsAre(0x33, 0xff));
}

TEST(PngTest, AppliesTransparentColors) {
  const Image gray =
      decodeImage(test::makePng({2, 1, 8, 0, 0, {{"tRNS", std::string("\0\7", 2)}}, std::string("\0\7\x8", 3)}), "a");
  EXPECT_EQ(gray.channels, 2u);
  EXPECT_THAT(bytesAsInts(gray), ElementsAre(7, 0, 8, 255));

  const std::string key("\0\1\0\2\0\3", 6);
  const Image rgb = decodeImage(test::makePng({2, 1, 8, 2, 0, {{"tRNS", key}}, std::string("\0\1\2\3\4\5\6", 7)}), "a");
  EXPECT_THAT(bytesAsInts(rgb), ElementsAre(1, 2, 3, 0, 4, 5, 6, 255));

  const Image wide =
      decodeImage(test::makePng({1, 1, 16, 2, 0, {{"tRNS", key}}, std::string("\0\0\1\0\2\0\3", 7)}), "a");
  EXPECT_EQ(wide.type, PixelType::u16);
  EXPECT_THAT(wide.samples<std::uint16_t>(), ElementsAre(1, 2, 3, 0));
  const Image wideGray =
      decodeImage(test::makePng({2, 1, 16, 0, 0, {{"tRNS", "\1\2"}}, std::string("\0\1\2\3\4", 5)}), "a");
  EXPECT_THAT(wideGray.samples<std::uint16_t>(), ElementsAre(0x102, 0, 0x304, 0xffff));
}

TEST(PngTest, ReadsInterlacedFiles) {
  // Adam7 order of a 3 x 3 image: pass 1 has (0,0), pass 4 (2,0), pass 5 (0,2) (2,2), pass 6 (1,0) (1,2), pass 7 row 1.
  test::PngParts parts{3, 3, 8, 0, 1, {}, {}};
  parts.rows = std::string(
      "\0\1"
      "\0\2"
      "\0\3\4"
      "\0\5"
      "\0\6"
      "\0\7\x8\x9",
      15);
  EXPECT_THAT(bytesAsInts(decodeImage(test::makePng(parts), "a.png")), ElementsAre(1, 5, 2, 7, 8, 9, 3, 6, 4));
}

TEST(PngTest, KeepsMetadata) {
  const Metadata metadata{{"Title", "a scene"}, {"quintet:seed", "7"}, {"Comment", "\u00e4\u4e00\nsecond line"}};
  const Bytes bytes = encodePng(makeGradient(4, 4, 3, PixelType::u8), metadata);
  EXPECT_EQ(readMetadata(bytes, "a.png"), metadata);
  EXPECT_TRUE(readMetadata(encodePng(makeGradient(4, 4, 3, PixelType::u8), {{"Empty", ""}}), "a.png").empty());
  EXPECT_TRUE(readMetadata(encodePng(makeGradient(4, 4, 3, PixelType::u8)), "a.png").empty());
}

TEST(PngTest, WritesTheColorEncoding) {
  Image image = makeGradient(4, 4, 3, PixelType::u8);
  const auto has = [&](const char* chunk) { return textOf(encodePng(image)).find(chunk) != std::string::npos; };
  EXPECT_TRUE(has("sRGB"));
  EXPECT_FALSE(has("gAMA"));
  image.encoding = ColorEncoding::linear;
  EXPECT_TRUE(has("gAMA"));
  EXPECT_FALSE(has("sRGB"));
}

TEST(PngTest, RejectsWrongChecksums) {
  const Bytes bytes = encodePng(makeGradient(4, 4, 3, PixelType::u8), {{"Title", "text"}});
  const std::string text = textOf(bytes);
  for (const char* chunk : {"IHDR", "tEXt", "IDAT", "IEND"}) {
    const std::size_t name = text.find(chunk);
    Bytes broken = bytes;
    broken[name + 4 + static_cast<std::size_t>(bytes[name - 1])] ^=
        std::byte{1};  // the chunk has less than 256 bytes of data
    EXPECT_THAT(imageError(broken), HasSubstr("checksum")) << chunk;
  }
}

TEST(PngTest, DecodesInvalidPaletteIndicesAsBlack) {
  const test::PngParts parts{2, 1, 8, 3, 0, {{"PLTE", "abc"}}, std::string("\0\0\1", 3)};
  EXPECT_THAT(bytesAsInts(decodeImage(test::makePng(parts), "a")), ElementsAre('a', 'b', 'c', 0, 0, 0));
}

TEST(PngTest, IgnoresUnknownAncillaryChunks) {
  const test::PngParts parts{
      1, 1, 8, 0, 0, {{"tIME", std::string("\7\xe8\x0d\x01\1\1\1", 7)}, {"quIn", "?"}}, std::string("\0\5", 2)};
  EXPECT_THAT(bytesAsInts(decodeImage(test::makePng(parts), "a.png")), ElementsAre(5));
}

TEST(JpegTest, ReadsBaselineProgressiveAndGray) {
  const Image rgb = makeGradient(67, 45, 3, PixelType::u8);
  for (const int sampling : {TJSAMP_444, TJSAMP_422, TJSAMP_420}) {
    for (const int flags : {0, TJFLAG_PROGRESSIVE}) {
      const Image back = decodeImage(test::encodeJpeg(rgb, 95, sampling, flags), "a.jpg");
      EXPECT_EQ(back.channels, 3u);
      EXPECT_LT(meanDifference(back, rgb), 3.0);
    }
  }
  const Image gray = makeGradient(67, 45, 1, PixelType::u8);
  EXPECT_LT(meanDifference(decodeImage(test::encodeJpeg(gray, 95, TJSAMP_GRAY, 0), "a.jpg"), gray), 2.0);
}

TEST(JpegTest, RejectsCmyk) {
  const Image four = makeGradient(16, 16, 4, PixelType::u8);
  EXPECT_THAT(imageError(test::encodeJpeg(four, 90, TJSAMP_444, 0)), AllOf(StartsWith("a.img: "), HasSubstr("CMYK")));
}

TEST(JpegTest, AllowsPaddingBetweenSegments) {
  const Bytes bytes = test::encodeJpeg(makeGradient(16, 16, 3, PixelType::u8), 90, TJSAMP_444, 0);
  const Image clean = decodeImage(bytes, "a.jpg");
  const std::size_t frame = textOf(bytes).find("\xff\xc0");
  for (const std::size_t at : {frame, bytes.size() - 2}) {  // before the frame header and before the end
    Bytes padded = bytes;
    padded.insert(padded.begin() + static_cast<std::ptrdiff_t>(at), 3, std::byte{0});
    EXPECT_TRUE(decodeImage(padded, "a.jpg").data == clean.data) << at;
  }
}

TEST(WebpTest, ReadsLosslessAndLossyFiles) {
  for (const std::uint32_t channels : {3u, 4u}) {
    const Image image = makeGradient(67, 45, channels, PixelType::u8);
    const Image lossless = decodeImage(test::encodeWebp(image, -1.0f), "a.webp");
    EXPECT_EQ(lossless.channels, channels);
    EXPECT_TRUE(lossless.data == image.data);
    const Image lossy = decodeImage(test::encodeWebp(image, 95.0f), "a.webp");
    EXPECT_EQ(lossy.channels, channels);
    EXPECT_LT(meanDifference(lossy, image), 4.0);
  }
}

TEST(CodecTest, ProbesWithoutDecoding) {
  for (const test::Sample& sample : test::allSamples()) {
    const Image image = decodeImage(sample.bytes, sample.name);
    const ImageInfo info = probeImage(sample.bytes, sample.name);
    EXPECT_EQ(info.width, image.width) << sample.name;
    EXPECT_EQ(info.height, image.height) << sample.name;
    EXPECT_EQ(info.channels, image.channels) << sample.name;
    EXPECT_EQ(info.type, image.type) << sample.name;
  }
  EXPECT_EQ(probeImage(test::encodeWebp(makeGradient(5, 6, 3, PixelType::u8), 50.0f), "a").format, "WebP");
}

TEST(CodecTest, RejectsUnknownContent) {
  EXPECT_THAT(imageError({}), AllOf(StartsWith("a.img: "), HasSubstr("empty")));
  EXPECT_THAT(imageError(test::bytesOf("GIF89a......")), HasSubstr("a.img: not a supported image"));
  EXPECT_THROW(readImage("/nonexistent/a.png"), FileError);
}

TEST(CodecTest, RejectsHugeSizesBeforeAllocating) {
  EXPECT_THAT(imageError(test::makePng({60000, 60000, 8, 6, 0, {}, "x"})),
              AllOf(HasSubstr("too large"), HasSubstr("60000 x 60000")));
  EXPECT_THAT(imageError(test::makePng({70000, 1, 8, 0, 0, {}, "x"})), HasSubstr("at most 65536"));
  EXPECT_THAT(imageError(test::makePng({16000, 16000, 8, 0, 0, {}, "x"})), HasSubstr("256000000 bytes"));
  EXPECT_THAT(imageError(test::makePng({0, 5, 8, 0, 0, {}, "x"})), HasSubstr("PNG"));
  EXPECT_THAT(imageError(test::bytesOf("#?RADIANCE\n\n-Y 60000 +X 60000\n")), HasSubstr("too large"));
  EXPECT_THAT(imageError(test::bytesOf("#?RADIANCE\n\n-Y 9000 +X 9000\nabcd")), HasSubstr("ends early"));
  Bytes jpeg = test::encodeJpeg(makeGradient(8, 8, 3, PixelType::u8), 90, TJSAMP_444, 0);
  const std::size_t frame = textOf(jpeg).find("\xff\xc0");
  for (const std::size_t i : {5u, 7u}) jpeg[frame + i] = std::byte{0x20};  // 8 + 0x2000 pixels
  EXPECT_THAT(imageError(jpeg), HasSubstr("header declares"));
}

TEST(WriteImageTest, SelectsTheFormatByExtension) {
  const quintet::test::TempFolder folder;
  const Image image = makeGradient(10, 10, 3, PixelType::f32);
  writeImage(folder / "a.png", image, {{"Title", "t"}});
  writeImage(folder / "a.EXR", image, {{"Title", "t"}});
  writeImage(folder / "a.hdr", image);
  EXPECT_EQ(readImage(folder / "a.png").data, toSrgb8(image).data);
  EXPECT_EQ(probeImage(readFile(folder / "a.EXR"), "a").format, "OpenEXR");
  EXPECT_EQ(probeImage(readFile(folder / "a.hdr"), "a").format, "Radiance HDR");
  EXPECT_THAT(readMetadata(readFile(folder / "a.EXR"), "a"), ElementsAre(Metadata::value_type("Title", "t")));
  EXPECT_THROW(writeImage(folder / "a.jpg", image), UsageError);
  EXPECT_THROW(writeImage(folder / "none/a.png", image), FileError);
  EXPECT_EQ(folder.entryCount(), 3u);
}

TEST(EncodeTest, RejectsInvalidImagesAndKeywords) {
  const Image good = makeGradient(4, 4, 3, PixelType::u8);
  EXPECT_THROW(encodePng(Image{}), UsageError);
  EXPECT_THROW(encodeExr(Image{}), UsageError);
  EXPECT_THROW(encodeHdr(Image{}), UsageError);
  EXPECT_THROW(encodePng(makeGradient(4, 4, 3, PixelType::f32)), UsageError);
  Image premultiplied = makeGradient(4, 4, 4, PixelType::u8);
  premultiplied.premultiplied = true;
  EXPECT_THROW(encodePng(premultiplied), UsageError);
  Image wrong = good;
  wrong.data.pop_back();
  EXPECT_THROW(encodePng(wrong), UsageError);
  for (const std::string key : {"", " a", "a ", "a  b", "\u00e4", "a\nb"}) {
    EXPECT_THROW(encodePng(good, {{key, "x"}}), UsageError) << key;
    EXPECT_THROW(encodeExr(good, {{key, "x"}}), UsageError) << key;
  }
  EXPECT_THROW(encodePng(good, {{std::string(80, 'a'), "x"}}), UsageError);
  EXPECT_THROW(encodePng(good, {{"a", std::string("x\0y", 3)}}), UsageError);
}

TEST(EncodeTest, IsDeterministic) {
  const Image image = makeGradient(33, 20, 4, PixelType::f32);
  EXPECT_EQ(encodeExr(image), encodeExr(image));
  EXPECT_EQ(encodeHdr(image), encodeHdr(image));
  EXPECT_EQ(encodePng(toSrgb8(image)), encodePng(toSrgb8(image)));
}

}  // namespace
}  // namespace quintet::io
