#include "aov_notes.h"

#include <algorithm>

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

AovLayer layerOf(const Json& json, std::size_t outputCount) {
  AovLayer layer;
  layer.name = json.at("name").get<std::string>();
  layer.channels = json.at("channels").get<std::vector<std::string>>();
  layer.exact = json.at("exact").get<bool>();
  const auto source = json.at("source").get<unsigned>();
  layer.output = json.at("output").get<std::size_t>();
  if (source > static_cast<unsigned>(AovLayer::Source::sampleCount) || layer.output >= outputCount)
    throw UsageError("the layers of the film are not those of its outputs");
  layer.source = static_cast<AovLayer::Source>(source);
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

std::vector<AovLayer> readAovLayers(const render::FilmFacts& notes, std::size_t outputCount) {
  try {
    std::vector<AovLayer> layers;
    for (const Json& layer : parse(notes, kLayers)) layers.push_back(layerOf(layer, outputCount));
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
