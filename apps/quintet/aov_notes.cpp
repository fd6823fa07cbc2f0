#include "aov_notes.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include <nlohmann/json.hpp>

#include "base/error.h"

namespace quintet::app {
namespace {

using Json = nlohmann::json;

constexpr const char* kLayers = "layers";
constexpr const char* kInstances = "names of instances";
constexpr const char* kMaterials = "names of materials";

std::string textOf(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

// Null where there is no such note.
Json parse(const render::FilmFacts& notes, const char* name) {
  const std::string* text = render::findFact(notes, name);
  return text ? Json::parse(*text) : Json();
}

bool isName(const std::string& text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

// The film has what the layer is made from.
bool canShow(const render::FilmState& film, const AovLayer& layer) {
  if (layer.source == AovLayer::Source::sampleCount) return true;
  if (layer.source == AovLayer::Source::variance) return !film.planes.at(0).squares.empty();
  if (layer.output >= film.planes.size() || !film.planes[layer.output].stored()) return false;
  const bool counts = film.planes[layer.output].pixel == program::OutputPixel::coverage;
  return counts == (layer.source == AovLayer::Source::coverage);
}

AovLayer layerOf(const Json& json, const render::FilmState& film) {
  AovLayer layer;
  layer.name = json.at("name").get<std::string>();
  layer.channels = json.at("channels").get<std::vector<std::string>>();
  layer.exact = json.at("exact").get<bool>();
  const auto source = json.at("source").get<unsigned>();
  layer.output = json.at("output").get<std::size_t>();
  layer.source = static_cast<AovLayer::Source>(std::min(source, static_cast<unsigned>(AovLayer::Source::sampleCount)));
  const bool named = layer.source == AovLayer::Source::coverage || std::ranges::all_of(layer.channels, isName);
  if (!isName(layer.name) || !named || source > static_cast<unsigned>(layer.source) || !canShow(film, layer))
    throw UsageError("the layers of the film are not those of its outputs");
  return layer;
}

}  // namespace

void addAovNotes(render::FilmFacts& notes, const std::vector<AovLayer>& layers, const CoverageNames& names) {
  if (layers.empty()) return;
  Json all = Json::array();
  for (const AovLayer& layer : layers)
    all.push_back({{"name", layer.name},
                   {"channels", layer.channels},
                   {"exact", layer.exact},
                   {"source", static_cast<unsigned>(layer.source)},
                   {"output", layer.output}});
  notes.emplace_back(kLayers, textOf(all));
  if (std::ranges::find(layers, AovLayer::Source::coverage, &AovLayer::source) == layers.end()) return;
  notes.emplace_back(kInstances, textOf(names.instances));
  notes.emplace_back(kMaterials, textOf(names.materials));
}

void joinAovNotes(render::FilmFacts& notes, const render::FilmFacts& others, const render::FilmState& film) {
  std::vector<AovLayer> layers = readAovLayers(notes, film);
  for (AovLayer& layer : readAovLayers(others, film))
    if (std::ranges::find(layers, layer.name, &AovLayer::name) == layers.end()) layers.push_back(std::move(layer));
  // As aovLayers() has them.
  const auto place = [](const AovLayer& layer) {
    const bool ofOutput = layer.source == AovLayer::Source::output || layer.source == AovLayer::Source::coverage;
    return std::pair(ofOutput ? AovLayer::Source::output : layer.source, layer.output);
  };
  std::ranges::sort(layers, {}, place);
  CoverageNames names = readCoverageNames(notes);
  if (names.instances.empty() && names.materials.empty()) names = readCoverageNames(others);
  std::erase_if(notes, [](const auto& note) {
    return note.first == kLayers || note.first == kInstances || note.first == kMaterials;
  });
  addAovNotes(notes, layers, names);
}

std::vector<AovLayer> readAovLayers(const render::FilmFacts& notes, const render::FilmState& film) {
  try {
    std::vector<AovLayer> layers;
    for (const Json& layer : parse(notes, kLayers)) layers.push_back(layerOf(layer, film));
    checkChannels(layers);
    return layers;
  } catch (const Json::exception&) {
    throw UsageError("the layers of the film cannot be read");
  }
}

CoverageNames readCoverageNames(const render::FilmFacts& notes) {
  try {
    CoverageNames names;
    if (const Json json = parse(notes, kInstances); !json.is_null()) json.get_to(names.instances);
    if (const Json json = parse(notes, kMaterials); !json.is_null()) json.get_to(names.materials);
    return names;
  } catch (const Json::exception&) {
    throw UsageError("the names of the film cannot be read");
  }
}

}  // namespace quintet::app
