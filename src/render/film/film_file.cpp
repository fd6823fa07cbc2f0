// SPDX-License-Identifier: Apache-2.0
#include "render/film/film_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cstring>
#include <initializer_list>
#include <new>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/plural.h"
#include "base/text.h"
#include "io/codec.h"

namespace quintet::render {
namespace {

using Bytes = std::span<const std::byte>;
using Json = nlohmann::ordered_json;

// Visits the arrays of a plane by their names in the header, with the number of elements per pixel.
template <class Plane, class Visit>
void forArrays(Plane& plane, const Visit& visit) {
  visit("sums", plane.sums, std::size_t{4});
  visit("squares", plane.squares, std::size_t{4});
  visit("values", plane.values, std::size_t{1});
  visit("coverage", plane.coverage, std::size_t{shared::kCoverageSlots});
}

// ---- Compressed blocks ----

static_assert(std::endian::native == std::endian::little, "arrays are stored in the byte order of memory");

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;  // approximate size before compression
constexpr std::size_t kLargestRatio = 1032;                // largest compression ratio of deflate (zlib documentation)
constexpr int kCompressionLevel = 1;                       // the low bytes are mostly noise, which no level compresses

std::size_t blockBytes(std::size_t elementBytes) {
  return std::max(kBlockBytes / elementBytes, std::size_t{1}) * elementBytes;
}

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

std::vector<std::byte> compress(std::span<const std::byte> bytes) {
  std::vector<std::byte> out(::compressBound(bytes.size()));
  uLongf size = out.size();
  const int code = ::compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), kCompressionLevel);
  if (code != Z_OK) throw std::bad_alloc();  // the only possible reason, because `out` is large enough
  out.resize(size);
  return out;
}

// Returns false unless the compressed bytes fill `out` exactly.
bool decompress(std::span<const std::byte> bytes, std::span<std::byte> out) {
  uLongf size = out.size();
  const int code = ::uncompress(reinterpret_cast<Bytef*>(out.data()), &size,
                                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  if (code == Z_MEM_ERROR) throw std::bad_alloc();
  return code == Z_OK && size == out.size();
}

// Appends `bytes`, whose elements have `elementBytes` each, as blocks.
void appendBlocks(std::vector<std::byte>& out, std::span<const std::byte> bytes, std::size_t elementBytes) {
  assert(bytes.size() % elementBytes == 0);
  const std::size_t size = blockBytes(elementBytes);
  std::vector<std::vector<std::byte>> blocks((bytes.size() + size - 1) / size);
  parallelFor(blocks.size(), [&](std::size_t i) {
    blocks[i] = compress(splitBytes(bytes.subspan(i * size, std::min(size, bytes.size() - i * size)), elementBytes));
  });
  for (const std::vector<std::byte>& block : blocks) {
    const auto length = static_cast<std::uint32_t>(block.size());
    const auto* begin = reinterpret_cast<const std::byte*>(&length);
    out.insert(out.end(), begin, begin + sizeof length);
    out.insert(out.end(), block.begin(), block.end());
  }
}

// Returns whether so many compressed bytes can hold `rawBytes`. Checked before memory is allocated for them.
bool blocksCanHold(std::size_t rawBytes, std::size_t compressedBytes) {
  return rawBytes / kLargestRatio <= compressedBytes;
}

// Fills `bytes` from the blocks at the front of `in`, and advances `in` past them. Returns false if the blocks are
// invalid.
bool takeBlocks(std::span<const std::byte>& in, std::span<std::byte> bytes, std::size_t elementBytes) {
  const std::size_t size = blockBytes(elementBytes);
  std::vector<std::span<const std::byte>> blocks((bytes.size() + size - 1) / size);
  for (std::span<const std::byte>& block : blocks) {
    std::uint32_t length = 0;
    if (in.size() < sizeof length) return false;
    std::memcpy(&length, in.data(), sizeof length);
    in = in.subspan(sizeof length);
    if (in.size() < length) return false;
    block = in.first(length);
    in = in.subspan(length);
  }
  std::atomic<bool> valid = true;
  parallelFor(blocks.size(), [&](std::size_t i) {
    const std::span<std::byte> part = bytes.subspan(i * size, std::min(size, bytes.size() - i * size));
    std::vector<std::byte> planes(part.size());
    if (decompress(blocks[i], planes))
      joinBytes(planes, part, elementBytes);
    else
      valid = false;
  });
  return valid;
}

// ---- Header ----

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

Json headerJson(const FilmFile& file) {
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

struct FilmHeader {
  FilmFile file;                                 // without its arrays
  std::size_t cells = 0, planned = 0;            // sizes of the arrays cellBatches and plan
  std::vector<std::vector<std::string>> arrays;  // names of the arrays of each plane
};

// Reads the header, whose checksum is already verified: any error was written on purpose. Throws FileError.
class HeaderReader {
 public:
  HeaderReader(const std::filesystem::path& file, std::span<const std::byte> header) : file_(file) {
    const auto* text = reinterpret_cast<const char*>(header.data());
    json_ = Json::parse(text, text + header.size(), nullptr, false);
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

// ---- File ----

// As in PNG: the first byte is not text, and the end reveals a transfer that changed line endings.
constexpr std::array<unsigned char, 8> kMagic{0x89, 'Q', 'F', 'I', 'L', 'M', '\r', '\n'};
constexpr std::size_t kPrefixBytes = 24;
constexpr std::size_t kHashBytes = 16;

struct Prefix {
  std::uint32_t version = kFilmFileVersion;
  std::uint32_t headerBytes = 0;
  std::uint64_t payloadBytes = 0;
};
static_assert(sizeof(Prefix) == kPrefixBytes - sizeof kMagic);

std::array<std::uint64_t, 2> hashOf(Bytes bytes) {
  const Hash hash = Hasher().add(bytes).finish();
  return {hash.high, hash.low};
}

template <class T>
void appendArray(std::vector<std::byte>& out, const std::vector<T>& values, std::size_t group = 1) {
  appendBlocks(out, std::as_bytes(std::span(values)), sizeof(T) * group);
}

// Reads the arrays in their order.
class Payload {
 public:
  Payload(const std::filesystem::path& file, Bytes bytes, MemoryBudget& budget)
      : file_(file), bytes_(bytes), budget_(budget) {}

  FilmFile fill(FilmHeader header) {
    FilmState& film = header.file.film;
    take(film.counts.cellBatches, header.cells);
    take(header.file.plan, header.planned);
    if (!areConsistent(film.counts, header.file.plan)) fail("no render has these numbers of batches");
    take(film.statistics, film.pixelCount());
    for (std::size_t i = 0; i < film.planes.size(); ++i) {
      const std::vector<std::string>& stored = header.arrays[i];
      forArrays(film.planes[i], [&](const char* name, auto& array, std::size_t group) {
        if (std::ranges::find(stored, name) != stored.end()) take(array, film.pixelCount() * group, group);
      });
    }
    if (!bytes_.empty()) fail(counted(bytes_.size(), "excess byte"));
    return std::move(header.file);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw FileError(file_, "payload", problem); }

  template <class T>
  void take(std::vector<T>& values, std::size_t count, std::size_t group = 1) {
    bool valid = blocksCanHold(count * sizeof(T), bytes_.size());
    if (valid) {
      budget_.take(count * sizeof(T));
      values.resize(count);
      valid = takeBlocks(bytes_, std::as_writable_bytes(std::span(values)), sizeof(T) * group);
    }
    if (!valid) fail("the blocks do not match the header");
  }

  const std::filesystem::path& file_;
  Bytes bytes_;
  MemoryBudget& budget_;
};

// Header and payload of a file whose length and checksum are valid.
struct Parts {
  Bytes header, payload;
};

Parts checkedParts(Bytes bytes, const std::filesystem::path& file) {
  if (bytes.empty()) throw FileError(file, "is empty");
  const std::size_t known = std::min(bytes.size(), kMagic.size());
  if (std::memcmp(bytes.data(), kMagic.data(), known) != 0) throw FileError(file, "is not a film file (.qfilm)");
  if (bytes.size() < kPrefixBytes)
    throw FileError(file, fmt::format("is truncated after {}", counted(bytes.size(), "byte")));
  Prefix prefix;
  std::memcpy(&prefix, bytes.data() + kMagic.size(), sizeof prefix);
  if (prefix.version != kFilmFileVersion)
    throw FileError(file, fmt::format("has version {} of the film format, but this Quintet reads version {}",
                                      prefix.version, kFilmFileVersion));
  const std::size_t rest = bytes.size() - kPrefixBytes;
  const std::uint64_t expected = prefix.headerBytes + kHashBytes;
  if (rest < expected || rest - expected < prefix.payloadBytes)
    throw FileError(file, fmt::format("is truncated after {}", counted(bytes.size(), "byte")));
  if (rest - expected > prefix.payloadBytes)
    throw FileError(
        file, fmt::format("is damaged: it has {}", counted(rest - expected - prefix.payloadBytes, "excess byte")));
  const auto hash = hashOf(bytes.first(bytes.size() - kHashBytes));
  if (std::memcmp(hash.data(), bytes.last(kHashBytes).data(), kHashBytes) != 0)
    throw FileError(file, "is damaged: its checksum does not match its content");
  return {bytes.subspan(kPrefixBytes, prefix.headerBytes),
          bytes.subspan(kPrefixBytes + prefix.headerBytes, prefix.payloadBytes)};
}

}  // namespace

const std::string* findFact(const FilmFacts& facts, const std::string& name) {
  const auto found = std::ranges::find(facts, name, &FilmFacts::value_type::first);
  return found == facts.end() ? nullptr : &found->second;
}

std::vector<FactDifference> differences(const FilmFacts& left, const FilmFacts& right) {
  std::vector<FactDifference> result;
  for (const auto& [name, value] : left) {
    const std::string* other = findFact(right, name);
    if (!other || *other != value) result.push_back({name, &value, other});
  }
  for (const auto& [name, value] : right)
    if (!findFact(left, name)) result.push_back({name, nullptr, &value});
  return result;
}

std::vector<std::byte> encodeFilm(const FilmFile& file) {
  const std::string header = headerJson(file).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  std::vector<std::byte> out(kPrefixBytes + header.size());
  std::memcpy(out.data() + kPrefixBytes, header.data(), header.size());
  appendArray(out, file.film.counts.cellBatches);
  appendArray(out, file.plan);
  appendArray(out, file.film.statistics);
  for (const FilmPlane& plane : file.film.planes)
    forArrays(plane, [&](const char*, const auto& array, std::size_t group) { appendArray(out, array, group); });
  const Prefix prefix{kFilmFileVersion, static_cast<std::uint32_t>(header.size()),
                      out.size() - kPrefixBytes - header.size()};
  std::memcpy(out.data(), kMagic.data(), kMagic.size());
  std::memcpy(out.data() + kMagic.size(), &prefix, sizeof prefix);
  const auto hash = hashOf(out);
  const Bytes hashBytes = std::as_bytes(std::span(hash));
  out.insert(out.end(), hashBytes.begin(), hashBytes.end());
  return out;
}

bool isFilmFile(Bytes bytes) {
  return bytes.size() >= kMagic.size() && std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) == 0;
}

FilmFile decodeFilm(Bytes bytes, const std::filesystem::path& file) {
  MemoryBudget budget(file, 0, Remedy::none);
  return decodeFilm(bytes, file, budget);
}

FilmFile decodeFilm(Bytes bytes, const std::filesystem::path& file, MemoryBudget& budget) {
  const Parts parts = checkedParts(bytes, file);
  return Payload(file, parts.payload, budget).fill(HeaderReader(file, parts.header).read());
}

void writeFilm(const std::filesystem::path& path, const FilmFile& file) { writeFile(path, encodeFilm(file)); }
FilmFile readFilm(const std::filesystem::path& path, std::size_t maxMemory) {
  MemoryBudget budget(path, maxMemory);
  return decodeFilm(readFile(path, budget), path, budget);
}

}  // namespace quintet::render
