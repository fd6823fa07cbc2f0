// SPDX-License-Identifier: Apache-2.0
// `quintet info` for images and films: OpenEXR files with parts, layers and attributes; other images; films.
#include <algorithm>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/memory_budget.h"
#include "base/plural.h"
#include "base/text.h"
#include "io/codec.h"
#include "io/exr/exr.h"
#include "job/film_store.h"
#include "job/provenance.h"
#include "output/info.h"
#include "output/json_line.h"
#include "render/film/film_file.h"
#include "scene/load.h"

namespace quintet::output {
namespace {

using Json = nlohmann::ordered_json;
using Part = io::ExrPartInfo;
using Bytes = std::span<const std::byte>;

constexpr std::size_t kMaxAttributeText = 240;  // characters: a manifest can have thousands
constexpr std::size_t kMaxFactText = 100;

std::string shortened(std::string text, std::size_t limit) {
  if (text.size() > limit) text = text.substr(0, limit) + "...";
  return text;
}

const char* typeText(io::ExrType type) {
  return type == io::ExrType::half ? "half" : type == io::ExrType::f32 ? "float" : "uint";
}

const char* typeText(io::PixelType type) {
  switch (type) {
    case io::PixelType::u8: return "8 bits";
    case io::PixelType::u16: return "16 bits";
    case io::PixelType::f32: return "float";
  }
  return "";
}

// Channels of one layer and one type: a layer with several types has several rows.
struct LayerRow {
  std::string name;
  io::ExrType type;
  std::vector<std::string> channels;  // without the layer's name
};

// The usual order of channels: R before G and B, A last.
std::size_t rankOf(const std::string& channel) {
  constexpr std::string_view kOrder = "RGBXYZWUVuvA";
  const std::size_t at = channel.size() == 1 ? kOrder.find(channel[0]) : kOrder.npos;
  return std::min(at, kOrder.size());
}

std::vector<LayerRow> layersOf(const Part& part) {
  std::vector<LayerRow> layers;
  for (const Part::Channel& channel : part.channels) {
    const std::string name(io::exrLayerOf(channel.name));
    auto at = std::ranges::find_if(layers, [&](const LayerRow& l) { return l.name == name && l.type == channel.type; });
    if (at == layers.end()) at = layers.insert(layers.end(), LayerRow{name, channel.type, {}});
    at->channels.push_back(channel.name.substr(name.empty() ? 0 : name.size() + 1));
  }
  for (LayerRow& layer : layers) std::ranges::stable_sort(layer.channels, {}, rankOf);
  std::ranges::stable_sort(layers,
                           [](const LayerRow& a, const LayerRow& b) { return a.name.empty() && !b.name.empty(); });
  return layers;
}

Json windowJson(const Part::Window& window) { return {window.x, window.y, window.width, window.height}; }

Json partJson(const Part& part) {
  Json layers = Json::array();
  for (const LayerRow& layer : layersOf(part))
    layers.push_back({{"name", layer.name}, {"type", typeText(layer.type)}, {"channels", layer.channels}});
  Json attributes = Json::object();
  for (const Part::Attribute& attribute : part.attributes)
    attributes[attribute.name] = {{"type", attribute.type}, {"value", attribute.text}};
  return {{"name", part.name},
          {"compression", part.compression},
          {"tiles", part.tileWidth > 0 ? Json{part.tileWidth, part.tileHeight} : Json()},
          {"deep", part.deep},
          {"dataWindow", windowJson(part.data)},
          {"displayWindow", windowJson(part.display)},
          {"layers", std::move(layers)},
          {"attributes", std::move(attributes)}};
}

std::string partText(const Part& part, bool several) {
  std::string text;
  if (several)
    text += fmt::format("   part {:<8}{}{}\n", printable(part.name), part.compression, part.deep ? ", deep" : "");
  const bool isWhole = part.data.x == part.display.x && part.data.y == part.display.y &&
                       part.data.width == part.display.width && part.data.height == part.display.height;
  if (!isWhole)
    text += fmt::format("   data window  {}x{} at {}, {}\n", part.data.width, part.data.height,
                        part.data.x - part.display.x, part.data.y - part.display.y);
  for (const LayerRow& layer : layersOf(part))
    text += fmt::format("   {:<24} {:<6} {}\n", layer.name.empty() ? "(beauty)" : printable(layer.name),
                        typeText(layer.type), printable(fmt::format("{}", fmt::join(layer.channels, " "))));
  return text;
}

std::string attributesText(const Part& part) {
  std::string text;
  for (const Part::Attribute& attribute : part.attributes) {
    std::string value = shortened(printable(attribute.text), kMaxAttributeText);
    if (attribute.text.empty() && attribute.type != "string") value = "(" + attribute.type + ")";
    text += fmt::format("   {:<13}{}{}\n", printable(attribute.name), attribute.name.size() >= 13 ? " " : "", value);
  }
  return text;
}

std::string exrInfo(const std::filesystem::path& file, Bytes bytes, bool json) {
  const std::vector<Part> parts = io::inspectExr(bytes, file.string());
  const Part& first = parts.front();
  std::size_t channels = 0;
  for (const Part& part : parts) channels += part.channels.size();
  if (json) {
    Json texts = Json::object(), all = Json::array();
    for (const Part& part : parts) all.push_back(partJson(part));
    for (const Part::Attribute& attribute : first.attributes)
      if (attribute.type == "string") texts[attribute.name] = attribute.text;
    return jsonLine({{"file", file.string()},
                     {"kind", "image"},
                     {"format", "OpenEXR"},
                     {"width", first.display.width},
                     {"height", first.display.height},
                     {"channels", channels},
                     {"type", "float"},
                     {"bytes", bytes.size()},
                     {"metadata", std::move(texts)},
                     {"parts", std::move(all)}});
  }
  const std::string layout =
      first.tileWidth > 0 ? fmt::format("tiles of {}x{}", first.tileWidth, first.tileHeight) : "scan lines";
  std::string text = fmt::format("{}: OpenEXR, {}x{}, {}, {}, {}, {}\n", printable(file.string()), first.display.width,
                                 first.display.height, counted(channels, "channel"), first.compression, layout,
                                 bytesText(bytes.size()));
  for (const Part& part : parts) text += partText(part, parts.size() > 1);
  return text + attributesText(first);
}

Json factsJson(const render::FilmFacts& facts) {
  Json json = Json::object();
  for (const auto& [name, value] : facts) json[name] = value;
  return json;
}

// `other`: facts that are printed, too. A fact of the identity that has the name of a note is its
// exact form: the hash of the scene's contents next to its name.
std::string factsText(const render::FilmFacts& facts, const render::FilmFacts& other) {
  std::string text;
  for (const auto& [name, value] : facts) {
    if (value.empty()) continue;
    const std::string label = !render::findFact(other, name) ? name
                              : name == "camera"             ? "camera projection"
                                                             : name + " contents";
    text += fmt::format("   {:<25} {}\n", printable(label), shortened(printable(value), kMaxFactText));
  }
  return text;
}

std::string filmInfo(const std::filesystem::path& file, Bytes bytes, bool json, MemoryBudget& budget) {
  const auto [film, provenance] = job::decodeStoredFilm(bytes, file, budget);
  const render::Region& region = film.film.region;
  if (!json) {
    const std::string planned =
        provenance.plannedSamples ? fmt::format(" of {}", *provenance.plannedSamples) : std::string();
    return fmt::format("{}: film, {}x{}, {}{}, {}\n", printable(file.string()), region.width, region.height,
                       job::samplesText(film.film), planned, bytesText(bytes.size())) +
           factsText(film.identity, film.notes) + factsText(film.notes, {});
  }
  Json samples = Json::array();
  for (const render::SampleRange& range : film.film.counts.ranges) samples.push_back({range.begin, range.end});
  Json result{{"file", file.string()},
              {"kind", "film"},
              {"width", region.width},
              {"height", region.height},
              {"samples", samples},
              {"bytes", bytes.size()},
              {"identity", factsJson(film.identity)},
              {"notes", factsJson(film.notes)}};
  if (provenance.adaptive) {
    render::SampleCounts planned = film.film.counts;
    planned.cellBatches = film.plan;
    result["adaptive"] = {{"average", render::averageSamples(region, film.film.counts)},
                          {"planned", film.plan.empty() ? Json() : Json(render::averageSamples(region, planned))}};
  }
  return jsonLine(result);
}

std::string imageInfo(const std::filesystem::path& file, Bytes bytes, bool json) {
  const io::ImageInfo info = io::probeImage(bytes, file.string());
  const io::Metadata metadata = io::readMetadata(bytes, file.string());
  if (json) {
    Json texts = Json::object();
    for (const auto& [keyword, text] : metadata) texts[keyword] = text;
    return jsonLine({{"file", file.string()},
                     {"kind", "image"},
                     {"format", info.format},
                     {"width", info.width},
                     {"height", info.height},
                     {"channels", info.channels},
                     {"type", typeText(info.type)},
                     {"bytes", bytes.size()},
                     {"metadata", std::move(texts)}});
  }
  std::string text =
      fmt::format("{}: {}, {}x{}, {}, {}, {}\n", printable(file.string()), info.format, info.width, info.height,
                  counted(info.channels, "channel"), typeText(info.type), bytesText(bytes.size()));
  for (const auto& [keyword, value] : metadata)
    text += fmt::format("   {:<13}{}\n", printable(keyword), printable(value));
  return text;
}

}  // namespace

std::string fileInfo(const std::filesystem::path& file, bool json, const scene::LoadOptions& options) {
  MemoryBudget budget(file, options.maxMemory);
  const std::vector<std::byte> bytes = readFile(file, budget);
  if (scene::sceneFormat(file, bytes) != scene::SceneFormat::none) return sceneInfo(file, json, options);
  if (io::isOpenExr(bytes)) return exrInfo(file, bytes, json);  // also of layers that are not an image
  if (render::isFilmFile(bytes)) return filmInfo(file, bytes, json, budget);
  return imageInfo(file, bytes, json);
}

}  // namespace quintet::output
