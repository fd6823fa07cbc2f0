#include "render/film_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "io/codec.h"
#include "render/film_blocks.h"

namespace quintet::render {
namespace {

using Json = nlohmann::ordered_json;
using Bytes = std::span<const std::byte>;

// As in PNG: the first byte is no text, the end shows a transfer that has changed line ends.
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

Json factsJson(const FilmFacts& facts) {
  Json json = Json::object();
  for (const auto& [name, value] : facts) json[name] = value;
  return json;
}

// The arrays of a plane that may be in a file, by name.
template <class Plane, class Visit>
void forArrays(Plane& plane, const Visit& visit) {
  visit("sums", plane.sums, std::size_t{4});
  visit("squares", plane.squares, std::size_t{4});
  visit("values", plane.values, std::size_t{1});
  visit("coverage", plane.coverage, std::size_t{shared::kCoverageSlots});
}

Json planeJson(const FilmPlane& plane) {
  Json arrays = Json::array();
  forArrays(plane, [&](const char* name, const auto& array, std::size_t) {
    if (!array.empty()) arrays.push_back(name);
  });
  return {{"name", plane.name}, {"pixel", program::outputPixelName(plane.pixel)}, {"arrays", arrays}};
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

template <class T>
void appendArray(std::vector<std::byte>& out, const std::vector<T>& values, std::size_t group = 1) {
  appendBlocks(out, std::as_bytes(std::span(values)), sizeof(T) * group);
}

// Reads what encodeFilm wrote; the checksum was right, so whatever is wrong was written like that.
class Reader {
 public:
  Reader(const std::filesystem::path& file, Bytes header, Bytes payload) : file_(file), payload_(payload) {
    const auto* text = reinterpret_cast<const char*>(header.data());
    json_ = Json::parse(text, text + header.size(), nullptr, false);
    if (!json_.is_object()) fail("is not a JSON object");
  }

  FilmFile read() {
    FilmFile result;
    FilmState& film = result.film;
    result.identity = facts("identity");
    result.notes = facts("notes");
    readRegion(film.region);
    readCounts(film);
    for (const Json& entry : member("planes", Json::value_t::array)) readPlane(film, entry);
    if (film.planes.empty()) fail("/planes is empty");
    takeArrays(result);
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw FileError(file_, "header", problem); }

  const Json& member(const char* name, Json::value_t type) const {
    const auto found = json_.find(name);
    if (found == json_.end() || found->type() != type) fail(fmt::format("/{} is missing or of another type", name));
    return *found;
  }

  static bool isNumber(const Json& value) {
    return value.is_number_unsigned() && value.get<std::uint64_t>() <= 0xFFFFFFFFu;
  }

  FilmFacts facts(const char* name) const {
    FilmFacts result;
    for (const auto& [key, value] : member(name, Json::value_t::object).items()) {
      if (!value.is_string()) fail(fmt::format("/{}/{} is not a text", name, key));
      result.emplace_back(key, value.get<std::string>());
    }
    return result;
  }

  void readRegion(Region& region) const {
    const Json& json = member("region", Json::value_t::array);
    if (json.size() != 4 || !std::ranges::all_of(json, isNumber)) fail("/region is not four numbers");
    region = {json[0], json[1], json[2], json[3]};
    const auto fits = [](std::uint64_t first, std::uint64_t size) {
      return size >= 1 && first + size <= io::kMaxImageSide;
    };
    if (!fits(region.x, region.width) || !fits(region.y, region.height)) fail("/region is not in an image");
  }

  void readCounts(FilmState& film) {
    for (const Json& json : member("samples", Json::value_t::array)) {
      if (!json.is_array() || json.size() != 2 || !std::ranges::all_of(json, isNumber))
        fail("/samples are not pairs of numbers");
      const SampleRange range{json[0], json[1]};
      const bool ordered = film.counts.ranges.empty() || film.counts.ranges.back().end < range.begin;
      if (!ordered || range.begin >= range.end || range.begin % kBatchSamples != 0) fail("/samples are not in order");
      film.counts.ranges.push_back(range);
    }
    cells_ = cellCount(film, "cells");
    planned_ = cellCount(film, "plan");
  }

  std::size_t cellCount(const FilmState& film, const char* name) const {
    const auto count = member(name, Json::value_t::number_unsigned).get<std::size_t>();
    if (count != 0 && count != 2 * std::size_t{tileCount(film.region)})
      fail(fmt::format("/{} does not belong to the region", name));
    return count;
  }

  // What a film has of an output: nothing, if nobody wanted it; of the first one its picture and the error of that.
  static bool mayHold(program::OutputPixel pixel, bool first, const std::vector<std::string>& names) {
    const auto are = [&](std::initializer_list<std::string> wanted) {
      return std::ranges::is_permutation(names, wanted);
    };
    if (pixel == program::OutputPixel::mean && (are({"sums", "squares"}) || are({"values"})))
      return true;  // values: of the last frame
    if (first) return false;
    if (names.empty()) return true;
    switch (pixel) {
      case program::OutputPixel::mean: return are({"sums"});
      case program::OutputPixel::center: return are({"values"});
      case program::OutputPixel::coverage: return are({"coverage"});
    }
    return false;
  }

  void readPlane(FilmState& film, const Json& json) {
    const std::string place = fmt::format("/planes/{}", film.planes.size());
    const auto text = [&](const char* name) {
      if (!json.is_object() || !json.contains(name) || !json[name].is_string())
        fail(fmt::format("{}/{} is not a text", place, name));
      return json[name].get<std::string>();
    };
    FilmPlane& plane = film.planes.emplace_back();
    plane.name = text("name");
    const std::string pixel = text("pixel");
    constexpr std::array kPixels{program::OutputPixel::mean, program::OutputPixel::center,
                                 program::OutputPixel::coverage};
    const auto found = std::ranges::find(kPixels, pixel, program::outputPixelName);
    if (found == kPixels.end()) fail(fmt::format("{}/pixel '{}' is unknown", place, pixel));
    plane.pixel = *found;
    if (!json.contains("arrays") || !json["arrays"].is_array()) fail(fmt::format("{}/arrays is missing", place));
    std::vector<std::string>& names = arrays_.emplace_back();
    for (const Json& name : json["arrays"]) names.push_back(name.is_string() ? name.get<std::string>() : "");
    std::size_t known = 0;
    forArrays(plane,
              [&](const char* name, const auto&, std::size_t) { known += std::ranges::count(names, name) == 1; });
    if (known != names.size()) fail(fmt::format("{}/arrays has an unknown one", place));
    if (!mayHold(plane.pixel, film.planes.size() == 1, names))
      fail(fmt::format("{}/arrays are not those of pixel '{}'", place, pixel));
  }

  void takeArrays(FilmFile& file) {
    FilmState& film = file.film;
    take(film.counts.cellBatches, cells_);
    take(file.plan, planned_);
    if (!arePossible(film.counts, file.plan))
      throw FileError(file_, "payload", "no rendering has such numbers of batches");
    take(film.statistics, film.pixelCount());
    for (std::size_t i = 0; i < film.planes.size(); ++i) {
      forArrays(film.planes[i], [&](const char* name, auto& array, std::size_t group) {
        if (std::ranges::find(arrays_[i], name) != arrays_[i].end()) take(array, film.pixelCount() * group, group);
      });
    }
    if (!payload_.empty())
      throw FileError(file_, "payload", fmt::format("{} bytes belong to nothing", payload_.size()));
  }

  template <class T>
  void take(std::vector<T>& values, std::size_t count, std::size_t group = 1) {
    bool right = blocksMayHold(count * sizeof(T), payload_.size());
    if (right) {
      values.resize(count);
      right = takeBlocks(payload_, std::as_writable_bytes(std::span(values)), sizeof(T) * group);
    }
    if (!right) throw FileError(file_, "payload", "its blocks do not belong to the header");
  }

  const std::filesystem::path& file_;
  Bytes payload_;
  Json json_;
  std::size_t cells_ = 0, planned_ = 0;
  std::vector<std::vector<std::string>> arrays_;  // by plane
};

// The file's parts, once its length and checksum are right.
struct Parts {
  Bytes header, payload;
};

Parts checkedParts(Bytes bytes, const std::filesystem::path& file) {
  if (bytes.empty()) throw FileError(file, "is empty");
  const std::size_t known = std::min(bytes.size(), kMagic.size());
  if (std::memcmp(bytes.data(), kMagic.data(), known) != 0) throw FileError(file, "is not a film file (.qfilm)");
  if (bytes.size() < kPrefixBytes) throw FileError(file, fmt::format("is truncated after {} bytes", bytes.size()));
  Prefix prefix;
  std::memcpy(&prefix, bytes.data() + kMagic.size(), sizeof prefix);
  if (prefix.version != kFilmFileVersion)
    throw FileError(file, fmt::format("has version {} of the film format; this Quintet reads version {}",
                                      prefix.version, kFilmFileVersion));
  const std::size_t rest = bytes.size() - kPrefixBytes;
  const std::uint64_t wanted = prefix.headerBytes + kHashBytes;
  if (rest < wanted || rest - wanted < prefix.payloadBytes)
    throw FileError(file, fmt::format("is truncated after {} bytes", bytes.size()));
  if (rest - wanted > prefix.payloadBytes)
    throw FileError(file, fmt::format("is damaged: it has {} bytes too many", rest - wanted - prefix.payloadBytes));
  const auto hash = hashOf(bytes.first(bytes.size() - kHashBytes));
  if (std::memcmp(hash.data(), bytes.last(kHashBytes).data(), kHashBytes) != 0)
    throw FileError(file, "is damaged: its checksum is not that of its content");
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
  const Parts parts = checkedParts(bytes, file);
  return Reader(file, parts.header, parts.payload).read();
}

void writeFilm(const std::filesystem::path& path, const FilmFile& file) { writeFile(path, encodeFilm(file)); }
FilmFile readFilm(const std::filesystem::path& path) { return decodeFilm(readFile(path), path); }

}  // namespace quintet::render
