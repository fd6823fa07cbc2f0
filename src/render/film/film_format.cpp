// SPDX-License-Identifier: Apache-2.0
#include "render/film/film_format.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <initializer_list>
#include <new>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/plural.h"
#include "base/text.h"
#include "io/codec.h"

namespace quintet::render {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "arrays are stored in the byte order of memory");

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;  // approximate size before compression
constexpr std::size_t kLargestRatio = 1032;                // largest compression ratio of deflate (zlib documentation)
constexpr int kCompressionLevel = 1;                       // the low bytes are mostly noise, which no level compresses

std::vector<std::byte> splitBytes(std::span<const std::byte> bytes, std::size_t elementBytes) {
  std::vector<std::byte> planes(bytes.size());
  const std::size_t count = bytes.size() / elementBytes;
  for (std::size_t b = 0; b < elementBytes; ++b)
    for (std::size_t i = 0; i < count; ++i) planes[b * count + i] = bytes[i * elementBytes + b];
  return planes;
}

void joinBytes(std::span<const std::byte> planes, std::span<std::byte> bytes, std::size_t elementBytes) {
  const std::size_t count = bytes.size() / elementBytes;
  for (std::size_t b = 0; b < elementBytes; ++b)
    for (std::size_t i = 0; i < count; ++i) bytes[i * elementBytes + b] = planes[b * count + i];
}

Json factsJson(const FilmFacts& facts) {
  Json json = Json::object();
  for (const auto& [name, value] : facts) json[name] = value;
  return json;
}

Json planeJson(const FilmPlane& plane) {
  Json arrays = Json::array();
  forArrays(plane, [&](const char* name, const auto& array, std::size_t) {
    if (!array.empty()) arrays.push_back(name);
  });
  return {{"name", plane.name},
          {"pixel", program::outputPixelName(plane.pixel)},
          {"kind", program::outputKindName(plane.kind)},
          {"color", plane.color},
          {"arrays", arrays}};
}

Json filmHeaderJson(const FilmFile& file) {
  const Region& region = file.film.region;
  Json ranges = Json::array(), planes = Json::array();
  for (const SampleRange& range : file.film.counts.ranges) ranges.push_back({range.begin, range.end});
  for (const FilmPlane& plane : file.film.planes) planes.push_back(planeJson(plane));
  return {{"identity", factsJson(file.identity)},
          {"notes", factsJson(file.notes)},
          {"region", {region.x, region.y, region.width, region.height}},
          {"samples", ranges},
          {"cells", file.film.counts.cellBatches.size()},
          {"plan", file.plan.size()},
          {"planes", planes}};
}

// Throws FileError.
class FilmHeaderReader {
 public:
  FilmHeaderReader(const std::filesystem::path& file, std::span<const std::byte> header) : file_(file) {
    const auto* text = reinterpret_cast<const char*>(header.data());
    json_ = findJson<Json>({text, header.size()}).value_or(nullptr);
    if (!json_.is_object()) fail("not a JSON object");
  }

  FilmHeader read() {
    FilmHeader result;
    FilmState& film = result.file.film;
    result.file.identity = facts("identity");
    result.file.notes = facts("notes");
    readRegion(film.region);
    readSamples(film.counts);
    result.cells = cellCount(film, "cells");
    result.planned = cellCount(film, "plan");
    for (const Json& entry : member("planes", Json::value_t::array)) readPlane(result, entry);
    if (film.planes.empty()) fail("/planes is empty");
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw FileError(file_, "header", problem); }

  const Json& member(const char* name, Json::value_t type) const {
    const auto found = json_.find(name);
    if (found == json_.end() || found->type() != type) fail(fmt::format("/{} is missing or has the wrong type", name));
    return *found;
  }

  static bool isNumber(const Json& value) {
    return value.is_number_unsigned() && value.get<std::uint64_t>() <= 0xFFFFFFFFu;
  }

  FilmFacts facts(const char* name) const {
    FilmFacts result;
    for (const auto& [key, value] : member(name, Json::value_t::object).items()) {
      if (!value.is_string()) fail(fmt::format("/{}/{} is not a string", name, key));
      result.emplace_back(key, value.get<std::string>());
    }
    return result;
  }

  void readRegion(Region& region) const {
    const Json& json = member("region", Json::value_t::array);
    if (json.size() != 4 || !std::ranges::all_of(json, isNumber)) fail("/region is not an array of four numbers");
    region = {json[0], json[1], json[2], json[3]};
    const auto fits = [](std::uint64_t first, std::uint64_t size) {
      return size >= 1 && first + size <= io::kMaxImageSide;
    };
    if (!fits(region.x, region.width) || !fits(region.y, region.height))
      fail(fmt::format("/region is not within an image of {0}x{0} pixels", io::kMaxImageSide));
  }

  void readSamples(SampleCounts& counts) const {
    for (const Json& json : member("samples", Json::value_t::array)) {
      if (!json.is_array() || json.size() != 2 || !std::ranges::all_of(json, isNumber))
        fail("/samples is not an array of pairs of numbers");
      const SampleRange range{json[0], json[1]};
      const bool ordered = counts.ranges.empty() || counts.ranges.back().end < range.begin;
      if (!ordered || range.begin >= range.end || range.begin % kBatchSamples != 0)
        fail("/samples is not sorted, or a range is empty or does not start at a batch");
      counts.ranges.push_back(range);
    }
  }

  std::size_t cellCount(const FilmState& film, const char* name) const {
    const auto count = member(name, Json::value_t::number_unsigned).get<std::size_t>();
    if (count != 0 && count != 2 * std::size_t{tileCount(film.region)})
      fail(fmt::format("/{} does not match the region", name));
    return count;
  }

  // Returns whether a film can store these arrays of an output: none for an optional output that was not requested; the
  // first output always has its values, and their squares if they are sums.
  static bool canHold(program::OutputPixel pixel, bool first, const std::vector<std::string>& names) {
    const auto are = [&](std::initializer_list<std::string> expected) {
      return std::ranges::is_permutation(names, expected);
    };
    if (pixel == program::OutputPixel::mean && (are({"sums", "squares"}) || are({"values"})))
      return true;  // values: the last frame of a program that accumulates
    if (first) return false;
    if (names.empty()) return true;
    switch (pixel) {
      case program::OutputPixel::mean: return are({"sums"});
      case program::OutputPixel::center: return are({"values"});
      case program::OutputPixel::coverage: return are({"coverage"});
    }
    return false;
  }

  // Returns the value of `all` whose name is the string at `key` of a plane.
  template <class Values, class NameOf>
  auto valueByName(const std::string& plane, const char* key, const std::string& name, const Values& all,
                   NameOf nameOf) const {
    const auto found = std::ranges::find(all, name, nameOf);
    if (found == all.end()) fail(printable(fmt::format("{}/{} '{}' is unknown", plane, key, name)));
    return *found;
  }

  void readPlane(FilmHeader& header, const Json& json) const {
    using program::OutputKind, program::OutputPixel;
    constexpr std::array kPixels{OutputPixel::mean, OutputPixel::center, OutputPixel::coverage};
    constexpr std::array kKinds{OutputKind::color, OutputKind::linear,  OutputKind::normal, OutputKind::depth,
                                OutputKind::id,    OutputKind::display, OutputKind::heat};
    FilmState& film = header.file.film;
    const std::string location = fmt::format("/planes/{}", film.planes.size());
    const auto text = [&](const char* name) {
      if (!json.is_object() || !json.contains(name) || !json[name].is_string())
        fail(fmt::format("{}/{} is not a string", location, name));
      return json[name].get<std::string>();
    };
    FilmPlane& plane = film.planes.emplace_back();
    plane.name = text("name");
    const std::string pixel = text("pixel");
    plane.pixel = valueByName(location, "pixel", pixel, kPixels, program::outputPixelName);
    plane.kind = valueByName(location, "kind", text("kind"), kKinds, program::outputKindName);
    if (!json.contains("color") || !json["color"].is_boolean())
      fail(fmt::format("{}/color is not a Boolean", location));
    plane.color = json["color"].get<bool>();
    if (!json.contains("arrays") || !json["arrays"].is_array()) fail(fmt::format("{}/arrays is missing", location));
    std::vector<std::string>& names = header.arrays.emplace_back();
    for (const Json& name : json["arrays"]) names.push_back(name.is_string() ? name.get<std::string>() : "");
    std::size_t known = 0;
    forArrays(plane,
              [&](const char* name, const auto&, std::size_t) { known += std::ranges::count(names, name) == 1; });
    if (known != names.size()) fail(fmt::format("{}/arrays has an unknown or repeated name", location));
    if (!canHold(plane.pixel, film.planes.size() == 1, names))
      fail(fmt::format("{}/arrays are not those of pixel '{}'", location, pixel));
  }

  const std::filesystem::path& file_;
  Json json_;
};

}  // namespace

FilmPrefix checkedFilmPrefix(std::span<const std::byte> start, std::uint64_t fileBytes,
                             const std::filesystem::path& file) {
  if (start.empty()) throw FileError(file, "is empty");
  const std::size_t known = std::min(start.size(), kFilmMagic.size());
  if (std::memcmp(start.data(), kFilmMagic.data(), known) != 0) throw FileError(file, "is not a film file (.qfilm)");
  const auto truncated = [&] {
    return FileError(file, fmt::format("is truncated after {}", counted(fileBytes, "byte")));
  };
  if (start.size() < kFilmPrefixBytes) throw truncated();
  FilmPrefix prefix;
  std::memcpy(&prefix, start.data() + kFilmMagic.size(), sizeof prefix);
  if (prefix.version != kFilmFormatVersion)
    throw FileError(file, fmt::format("has version {} of the film format, but this Quintet reads version {}",
                                      prefix.version, kFilmFormatVersion));
  const std::uint64_t rest = fileBytes - kFilmPrefixBytes;
  const std::uint64_t expected = prefix.headerBytes + kFilmHashBytes;
  if (rest < expected || rest - expected < prefix.payloadBytes) throw truncated();
  if (rest - expected > prefix.payloadBytes)
    throw FileError(
        file, fmt::format("is damaged: it has {}", counted(rest - expected - prefix.payloadBytes, "excess byte")));
  return prefix;
}

std::array<std::uint64_t, 2> filmHash(const Hash& hash) { return {hash.high, hash.low}; }

bool FilmHeader::stores(std::size_t plane, std::string_view array) const {
  return std::ranges::find(arrays[plane], array) != arrays[plane].end();
}

FilmHeader parseFilmHeader(std::span<const std::byte> header, const std::filesystem::path& file) {
  return FilmHeaderReader(file, header).read();
}

std::string filmHeaderText(const FilmFile& file) {
  return filmHeaderJson(file).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::size_t filmBlockBytes(std::size_t elementBytes) {
  return std::max(kBlockBytes / elementBytes, std::size_t{1}) * elementBytes;
}

std::size_t largestFilmBlock(std::size_t rawBytes) { return ::compressBound(rawBytes); }

bool filmBlocksCanHold(std::size_t rawBytes, std::size_t compressedBytes) {
  return rawBytes / kLargestRatio <= compressedBytes;
}

std::vector<std::byte> encodeFilmBlock(std::span<const std::byte> bytes, std::size_t elementBytes) {
  const std::vector<std::byte> planes = splitBytes(bytes, elementBytes);
  std::vector<std::byte> out(::compressBound(planes.size()));
  uLongf size = out.size();
  const int code = ::compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                               reinterpret_cast<const Bytef*>(planes.data()), planes.size(), kCompressionLevel);
  if (code != Z_OK) throw std::bad_alloc();  // the only possible reason, because `out` is large enough
  out.resize(size);
  return out;
}

bool decodeFilmBlock(std::span<const std::byte> block, std::span<std::byte> out, std::size_t elementBytes) {
  std::vector<std::byte> planes(out.size());
  uLongf size = planes.size();
  const int code = ::uncompress(reinterpret_cast<Bytef*>(planes.data()), &size,
                                reinterpret_cast<const Bytef*>(block.data()), block.size());
  if (code == Z_MEM_ERROR) throw std::bad_alloc();
  if (code != Z_OK || size != planes.size()) return false;
  joinBytes(planes, out, elementBytes);
  return true;
}

}  // namespace quintet::render
