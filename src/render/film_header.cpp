#include "render/film_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "io/codec.h"

namespace quintet::render {
namespace {

using Json = nlohmann::ordered_json;

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

class HeaderReader {
 public:
  HeaderReader(const std::filesystem::path& file, std::span<const std::byte> header) : file_(file) {
    const auto* text = reinterpret_cast<const char*>(header.data());
    json_ = Json::parse(text, text + header.size(), nullptr, false);
    if (!json_.is_object()) fail("is not a JSON object");
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

  void readSamples(SampleCounts& counts) const {
    for (const Json& json : member("samples", Json::value_t::array)) {
      if (!json.is_array() || json.size() != 2 || !std::ranges::all_of(json, isNumber))
        fail("/samples are not pairs of numbers");
      const SampleRange range{json[0], json[1]};
      const bool ordered = counts.ranges.empty() || counts.ranges.back().end < range.begin;
      if (!ordered || range.begin >= range.end || range.begin % kBatchSamples != 0) fail("/samples are not in order");
      counts.ranges.push_back(range);
    }
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

  void readPlane(FilmHeader& header, const Json& json) const {
    FilmState& film = header.file.film;
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
    std::vector<std::string>& names = header.arrays.emplace_back();
    for (const Json& name : json["arrays"]) names.push_back(name.is_string() ? name.get<std::string>() : "");
    std::size_t known = 0;
    forArrays(plane,
              [&](const char* name, const auto&, std::size_t) { known += std::ranges::count(names, name) == 1; });
    if (known != names.size()) fail(fmt::format("{}/arrays has an unknown one", place));
    if (!mayHold(plane.pixel, film.planes.size() == 1, names))
      fail(fmt::format("{}/arrays are not those of pixel '{}'", place, pixel));
  }

  const std::filesystem::path& file_;
  Json json_;
};

}  // namespace

std::string filmHeaderText(const FilmFile& file) {
  return headerJson(file).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

FilmHeader readFilmHeader(std::span<const std::byte> header, const std::filesystem::path& file) {
  return HeaderReader(file, header).read();
}

}  // namespace quintet::render
