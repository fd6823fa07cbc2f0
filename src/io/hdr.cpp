// SPDX-License-Identifier: Apache-2.0
// Radiance HDR (RGBE), from the descriptions in Radiance's "File Formats" (Ward 2006) and "Real Pixels" (Graphics Gems
// II, 1991). This is an own implementation because stb_image supports one orientation and one of the two run-length
// encodings, ignores EXPOSURE, and returns zeros for truncated data.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "io/codec.h"
#include "io/formats.h"

namespace quintet::io {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

constexpr std::uint32_t kMinRunWidth = 8;  // scan lines of other widths use the old encoding
constexpr std::uint32_t kMaxRunWidth = 32767;

struct Header {
  std::uint32_t width = 0;  // of the decoded image
  std::uint32_t height = 0;
  bool columns = false;      // scan lines run along y ("+X 8 -Y 4")
  bool rightToLeft = false;  // -X
  bool bottomToTop = false;  // +Y
  double exposure = 1.0;
  std::size_t pixels = 0;  // offset of the first scan line
  std::uint32_t lineLength() const { return columns ? height : width; }
  std::uint32_t lineCount() const { return columns ? width : height; }
};

bool matches(const Source& source) { return source.has(0, "#?RADIANCE") || source.has(0, "#?RGBE"); }

// Returns the line at `at` and moves `at` behind the newline.
std::string_view readLine(const Source& source, std::size_t& at) {
  const std::string_view text(reinterpret_cast<const char*>(source.data()), source.size());
  const std::size_t end = text.find('\n', at);
  if (end == std::string_view::npos) source.fail(source.size(), "the Radiance HDR header ends early");
  std::string_view line = text.substr(at, end - at);
  at = end + 1;
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

template <class Number>
bool parse(std::string_view text, Number& value) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  while (text.ends_with(' ') || text.ends_with('\t')) text.remove_suffix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

// Parses "-Y 512 +X 1024". The first axis is the one that changes from scan line to scan line.
bool parseResolution(std::string_view line, Header& header) {
  for (int axis = 0; axis < 2; ++axis) {
    if (line.size() < 4 || (line[0] != '-' && line[0] != '+') || line[2] != ' ') return false;
    const bool isX = line[1] == 'X';
    if ((!isX && line[1] != 'Y') || (axis == 1 && isX == header.columns)) return false;
    if (axis == 0) header.columns = isX;
    if (isX) header.rightToLeft = line[0] == '-';
    if (!isX) header.bottomToTop = line[0] == '+';
    const std::string_view rest = line.substr(3);
    const std::size_t space = axis == 0 ? rest.find(' ') : rest.size();
    if (space == std::string_view::npos || !parse(rest.substr(0, space), isX ? header.width : header.height))
      return false;
    line = rest.substr(std::min(space + 1, rest.size()));
  }
  return true;
}

Header readHeader(const Source& source) {
  Header header;
  std::size_t at = 0;
  for (std::string_view line = readLine(source, at); !line.empty();) {
    const std::size_t start = at;
    line = readLine(source, at);
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
      source.fail(start, fmt::format("Radiance HDR with {} is not supported, only 32-bit_rle_rgbe", line));
    if (!line.starts_with("EXPOSURE=")) continue;
    double factor = 0.0;
    if (!parse(line.substr(9), factor) || !(factor > 0.0) || !std::isfinite(factor))
      source.fail(start, "broken Radiance HDR: EXPOSURE is not a positive number");
    header.exposure *= factor;
  }
  const std::size_t start = at;
  if (!parseResolution(readLine(source, at), header))
    source.fail(start, "broken Radiance HDR: invalid resolution line (expected for example '-Y 512 +X 1024')");
  source.checkSize(header.width, header.height, 3 * sizeof(float));
  header.pixels = at;
  return header;
}

// Decodes the scan lines in the order of the file.
class LineReader {
 public:
  LineReader(const Source& source, std::size_t offset) : source_(source), at_(offset) {}

  void readLine(std::span<Rgbe> line) {
    const bool mayBeEncoded = line.size() >= kMinRunWidth && line.size() <= kMaxRunWidth;
    need(4);
    if (!mayBeEncoded || source_[at_] != 2 || source_[at_ + 1] != 2 || source_[at_ + 2] >= 128) return readOld(line);
    if ((source_[at_ + 2] << 8 | source_[at_ + 3]) != static_cast<int>(line.size()))
      source_.fail(at_, "broken Radiance HDR: a scan line has a wrong width");
    at_ += 4;
    for (std::size_t component = 0; component < 4; ++component) readComponent(line, component);
  }

 private:
  void need(std::size_t bytes) const {
    if (bytes > source_.size() - at_) source_.fail(source_.size(), "Radiance HDR data ends early");
  }

  void readComponent(std::span<Rgbe> line, std::size_t component) {
    for (std::size_t x = 0; x < line.size();) {
      need(2);
      const std::size_t code = source_[at_++];
      const bool run = code > 128;
      const std::size_t count = run ? code - 128 : code;
      if (count == 0 || count > line.size() - x)
        source_.fail(at_ - 1, "broken Radiance HDR: a run exceeds its scan line");
      need(run ? 1 : count);
      for (std::size_t i = 0; i < count; ++i) line[x + i][component] = source_[at_ + (run ? 0 : i)];
      at_ += run ? 1 : count;
      x += count;
    }
  }

  // Reads pixels one by one. (1,1,1,n) repeats the previous pixel n times; consecutive repetitions are higher bytes of
  // n.
  void readOld(std::span<Rgbe> line) {
    int shift = 0;
    for (std::size_t x = 0; x < line.size(); at_ += 4) {
      need(4);
      const Rgbe pixel{source_[at_], source_[at_ + 1], source_[at_ + 2], source_[at_ + 3]};
      if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
        line[x++] = pixel;
        shift = 0;
        continue;
      }
      const std::size_t count = shift > 16 ? line.size() + 1 : static_cast<std::size_t>(pixel[3]) << shift;
      if (x == 0 || count > line.size() - x) source_.fail(at_, "broken Radiance HDR: a run exceeds its scan line");
      std::fill_n(line.begin() + static_cast<std::ptrdiff_t>(x), count, line[x - 1]);
      x += count;
      shift += 8;
    }
  }

  const Source& source_;
  std::size_t at_;
};

ImageInfo probe(const Source& source) {
  const Header header = readHeader(source);
  return {header.width, header.height, 3, PixelType::f32, {}, sizeof(Rgbe) * header.width * header.height};
}

Image decode(const Source& source) {
  const Header header = readHeader(source);
  // The buffer grows with the data that was read, so that a header alone cannot make it large.
  std::vector<Rgbe> pixels;
  LineReader reader(source, header.pixels);
  for (std::uint32_t i = 0; i < header.lineCount(); ++i) {
    pixels.resize(pixels.size() + header.lineLength());
    reader.readLine(std::span(pixels).last(header.lineLength()));
  }

  std::array<float, 256> scale{};  // by exponent; exponent 0 is black
  for (int e = 1; e < 256; ++e)
    scale[e] = static_cast<float>(std::min(std::ldexp(1.0, e - 136) / header.exposure,
                                           static_cast<double>(std::numeric_limits<float>::max()) / 255.0));
  Image image = makeImage(header.width, header.height, 3, PixelType::f32, ColorEncoding::linear);
  const Rgbe* from = pixels.data();
  for (std::uint32_t line = 0; line < header.lineCount(); ++line) {
    for (std::uint32_t i = 0; i < header.lineLength(); ++i, ++from) {
      const std::uint32_t x = header.columns ? line : i;
      const std::uint32_t y = header.columns ? i : line;
      const std::span<float> to = image.pixel<float>(header.rightToLeft ? header.width - 1 - x : x,
                                                     header.bottomToTop ? header.height - 1 - y : y);
      for (std::size_t c = 0; c < 3; ++c) to[c] = scale[(*from)[3]] * static_cast<float>((*from)[c]);
    }
  }
  return image;
}

Rgbe toRgbe(std::span<const float> rgb) {
  constexpr float kMax = 0x1.fep+126f;  // 255 · 2^(255-136)
  std::array<float, 3> value;
  for (std::size_t c = 0; c < 3; ++c) value[c] = rgb[c] > 0.0f ? std::min(rgb[c], kMax) : 0.0f;
  const float largest = std::max({value[0], value[1], value[2]});
  if (largest < 0x1p-128f) return {0, 0, 0, 0};
  int exponent = 0;
  std::frexp(largest, &exponent);
  if (std::lround(std::ldexp(largest, 8 - exponent)) == 256) ++exponent;
  exponent = std::max(exponent, -127);
  Rgbe pixel{};
  for (std::size_t c = 0; c < 3; ++c)
    pixel[c] = static_cast<std::uint8_t>(std::lround(std::ldexp(value[c], 8 - exponent)));
  pixel[3] = static_cast<std::uint8_t>(exponent + 128);
  return pixel;
}

// Appends runs of at least three equal bytes as (128 + length, value), other bytes as (length, values…).
void appendComponent(std::vector<std::byte>& out, std::span<const Rgbe> line, std::size_t component) {
  const auto at = [&](std::size_t i) { return std::byte{line[i][component]}; };
  const auto runAt = [&](std::size_t begin) {
    std::size_t end = begin + 1;
    while (end < line.size() && end - begin < 127 && at(end) == at(begin)) ++end;
    return end - begin;
  };
  for (std::size_t x = 0; x < line.size();) {
    std::size_t end = x;
    std::size_t run = 0;
    while (end < line.size() && end - x < 128 && (run = runAt(end)) < 3) ++end;
    if (end > x) {
      out.push_back(static_cast<std::byte>(end - x));
      for (; x < end; ++x) out.push_back(at(x));
    } else {
      out.push_back(static_cast<std::byte>(128 + run));
      out.push_back(at(x));
      x += run;
    }
  }
}

}  // namespace

const Format kHdr{"Radiance HDR", matches, probe, decode, nullptr};

std::vector<std::byte> encodeHdr(const Image& image) {
  checkEncodable(image, "Radiance HDR");
  const Image rgb = toChannels(toPremultiplied(image), 3);
  const std::string header =
      fmt::format("#?RADIANCE\nSOFTWARE=quintet\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", image.height, image.width);
  const auto text = std::as_bytes(std::span(header));
  std::vector<std::byte> out(text.begin(), text.end());
  std::vector<Rgbe> line(image.width);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) line[x] = toRgbe(rgb.pixel<float>(x, y));
    if (image.width < kMinRunWidth || image.width > kMaxRunWidth) {
      for (const Rgbe& pixel : line)
        for (const std::uint8_t value : pixel) out.push_back(std::byte{value});
      continue;
    }
    for (const std::uint32_t value : {2u, 2u, image.width >> 8, image.width & 255})
      out.push_back(static_cast<std::byte>(value));
    for (std::size_t component = 0; component < 4; ++component) appendComponent(out, line, component);
  }
  return out;
}

}  // namespace quintet::io
