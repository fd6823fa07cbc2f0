#include "exr_output.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "values.h"

namespace quintet::app {
namespace {

constexpr std::uint32_t kMinTile = 8;  // pixels; smaller ones make files of headers

io::ExrCompression compressionByName(const std::string& name) {
  const std::vector<std::string>& names = io::exrCompressionNames();
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw UsageError(fmt::format("--exr-compression: there is no '{}'{}; there are {}", plain(name),
                                 suggestion(name, names), fmt::join(names, ", ")));
  return static_cast<io::ExrCompression>(found - names.begin());
}

double whole(const std::string& option, const std::string& text, double min, double max) {
  const double value = parseNumber(option, text, min, max);
  if (std::floor(value) != value) throw UsageError(fmt::format("{}: '{}' is not a whole number", option, plain(text)));
  return value;
}

}  // namespace

io::ExrType parseExrType(const std::string& text) {
  const std::vector<std::string> names{"half", "float"};
  if (text == names[0]) return io::ExrType::half;
  if (text == names[1]) return io::ExrType::f32;
  throw UsageError(fmt::format("--exr-type: there is no '{}'{}; there are {}", plain(text), suggestion(text, names),
                               fmt::join(names, ", ")));
}

void parseExrCompression(const std::string& text, io::ExrOptions& options) {
  const std::string option = "--exr-compression";
  const std::size_t colon = text.find(':');
  options.compression = compressionByName(text.substr(0, colon));
  options.level.reset();
  if (colon == text.npos) return;
  const std::string level = text.substr(colon + 1);
  switch (options.compression) {
    case io::ExrCompression::zip:
    case io::ExrCompression::zips: options.level = static_cast<float>(whole(option, level, 1, 9)); return;
    case io::ExrCompression::dwaa:
    case io::ExrCompression::dwab: options.level = static_cast<float>(parseNumber(option, level, 0, 10000)); return;
    default: throw UsageError(fmt::format("{}: {} has no level", option, text.substr(0, colon)));
  }
}

std::uint32_t parseExrTiles(const std::string& text) {
  return static_cast<std::uint32_t>(whole("--exr-tiles", text, kMinTile, io::kMaxExrTile));
}

void addLayer(io::ExrPicture& picture, const std::string& layer, std::span<const std::string> suffixes,
              const io::Image& image, io::ExrType colors, bool exact) {
  const std::span<const float> samples = image.samples<float>();
  for (std::size_t c = 0; c < suffixes.size() && c < image.channels; ++c) {
    io::ExrChannel& channel = picture.channels.emplace_back();
    channel.name = layer.empty() ? suffixes[c] : layer + "." + suffixes[c];
    channel.type = exact ? io::ExrType::f32 : colors;
    channel.exact = exact;
    channel.samples.resize(image.pixelCount());
    for (std::size_t i = 0; i < channel.samples.size(); ++i) channel.samples[i] = samples[i * image.channels + c];
  }
}

void addBeauty(io::ExrPicture& picture, const io::Image& image, bool alpha, io::ExrType colors, bool exact) {
  const std::vector<std::string> names{"R", "G", "B", "A"};
  addLayer(picture, "", std::span(names).first(alpha ? 4 : 3), image, colors, exact);
}

io::ExrPicture exrPicture(const render::Region& region, std::uint32_t width, std::uint32_t height,
                          io::Metadata metadata) {
  io::ExrPicture picture{region.width, region.height, {}, std::move(metadata)};
  picture.place = {region.x, region.y, width, height};
  return picture;
}

}  // namespace quintet::app
