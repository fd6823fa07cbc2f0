#include "io/exr_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace quintet::io {
namespace {

constexpr float kMaxDwaLevel = 10000.0f;
constexpr std::size_t kMaxName = 255;  // bytes

// Dots separate layers; control characters would end names or lines.
bool isChannelName(const std::string& name) {
  return !name.empty() && name.size() <= kMaxName && name.front() != '.' && name.back() != '.' &&
         name.find("..") == std::string::npos &&
         std::ranges::all_of(name, [](unsigned char c) { return c >= 32 && c != 127; });
}

void checkChannel(const ExrChannel& channel, std::size_t pixels, const ExrPicture& picture) {
  if (!isChannelName(channel.name))
    throw UsageError(fmt::format("'{}' cannot be the name of an OpenEXR channel", channel.name));
  if (!channel.integers.empty() && channel.type != ExrType::u32)
    throw UsageError(fmt::format("the OpenEXR channel '{}' has integers but is not of their type", channel.name));
  const std::size_t count = channel.integers.empty() ? channel.samples.size() : channel.integers.size();
  if (count != pixels)
    throw UsageError(fmt::format("the OpenEXR channel '{}' has {} samples for {} x {} pixels", channel.name, count,
                                 picture.width, picture.height));
}

void checkPlace(const ExrPicture& picture) {
  const ExrPlace place = wholePlace(picture);
  if (place.width > kMaxImageSide || place.height > kMaxImageSide)
    throw UsageError(fmt::format("{} x {} pixels are too many for a picture; at most {} a side", place.width,
                                 place.height, kMaxImageSide));
  if (std::uint64_t{place.x} + picture.width > place.width || std::uint64_t{place.y} + picture.height > place.height)
    throw UsageError(fmt::format("{} x {} pixels at {}, {} reach beyond the picture of {} x {}", picture.width,
                                 picture.height, place.x, place.y, place.width, place.height));
}

// OpenEXR counts the bytes of a tile as int.
void checkTiles(std::size_t channels, std::uint32_t size) {
  if (size > kMaxExrTile)
    throw UsageError(fmt::format("OpenEXR tiles of {} pixels are too large; at most {}", size, kMaxExrTile));
  if (std::uint64_t{size} * size * channels * sizeof(float) > std::numeric_limits<std::int32_t>::max())
    throw UsageError(fmt::format("OpenEXR tiles of {} pixels and {} channels are too large together", size, channels));
}

}  // namespace

ExrPlace wholePlace(const ExrPicture& picture) {
  if (picture.place.width > 0 || picture.place.height > 0) return picture.place;
  return {picture.place.x, picture.place.y, picture.place.x + picture.width, picture.place.y + picture.height};
}

void checkExrSize(std::uint32_t width, std::uint32_t height, std::size_t channels, std::uint32_t tileSize) {
  if (channels > kMaxExrChannels)
    throw UsageError(
        fmt::format("{} channels are too many for an OpenEXR file; at most {}", channels, kMaxExrChannels));
  if (std::uint64_t{width} * height * channels * sizeof(float) > kMaxPictureBytes)
    throw UsageError(fmt::format("{} channels of {} x {} pixels are too large for one OpenEXR file ({} GiB at most)",
                                 channels, width, height, kMaxPictureBytes >> 30));
  checkTiles(channels, tileSize);
}

void checkExrPicture(const ExrPicture& picture) {
  const std::uint64_t pixels = std::uint64_t{picture.width} * picture.height;
  if (pixels == 0 || picture.channels.empty()) throw UsageError("an image without pixels cannot be written as OpenEXR");
  checkPlace(picture);
  checkExrSize(picture.width, picture.height, picture.channels.size());
  std::vector<std::string> names;
  for (const ExrChannel& channel : picture.channels) {
    checkChannel(channel, pixels, picture);
    names.push_back(channel.name);
  }
  std::ranges::sort(names);
  if (const auto twice = std::ranges::adjacent_find(names); twice != names.end())
    throw UsageError(fmt::format("the OpenEXR channel '{}' is given twice", *twice));
}

void checkExrOptions(const ExrPicture& picture, const ExrOptions& options) {
  const auto index = static_cast<std::size_t>(options.compression);
  if (index >= exrCompressionNames().size()) throw UsageError("there is no such compression of OpenEXR");
  const std::string& name = exrCompressionNames()[index];
  checkTiles(picture.channels.size(), options.tileSize);
  if (!options.level) return;
  const float level = *options.level;
  switch (options.compression) {
    case ExrCompression::zip:
    case ExrCompression::zips:
      if (!(level >= 1 && level <= 9) || std::floor(level) != level)
        throw UsageError(fmt::format("the level of {} is a whole number from 1 to 9, not {}", name, level));
      return;
    case ExrCompression::dwaa:
    case ExrCompression::dwab:
      if (!(level >= 0 && level <= kMaxDwaLevel))
        throw UsageError(fmt::format("the level of {} is a number from 0 to {}, not {}", name, kMaxDwaLevel, level));
      return;
    default: throw UsageError(fmt::format("the compression {} has no level", name));
  }
}

const std::vector<std::string>& exrCompressionNames() {
  static const std::vector<std::string> kNames{"none", "rle", "zips", "zip", "piz", "dwaa", "dwab"};
  return kNames;
}

}  // namespace quintet::io
