// SPDX-License-Identifier: Apache-2.0
#include "output/layers.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "output/cryptomatte_layer.h"
#include "program/heat.h"

namespace quintet::output {
namespace {

using program::OutputPixel;

Layer layerOf(const program::Program& program, std::size_t output) {
  const program::Output& description = program.outputs[output];
  Layer layer{
      description.name, description.help, program::outputChannels(description), true, Layer::Source::output, output};
  layer.exact = !program::holdsColor(description);
  if (description.pixel == OutputPixel::coverage) {
    layer.source = Layer::Source::coverage;
    layer.channels = {fmt::format("{}00-{:02}", cryptomatteType(description.name), kCryptomatteLayers - 1), "RGBA"};
    layer.exact = true;
  }
  return layer;
}

// As the file names them.
std::vector<std::string> fileChannels(const Layer& layer) {
  if (layer.source == Layer::Source::coverage) return cryptomatteChannels(layer.name);
  std::vector<std::string> names;
  for (const std::string& suffix : layer.channels) names.push_back(layer.name + "." + suffix);
  return names;
}

// Readers of Cryptomatte treat a type name followed by digits as a layer of the type: CryptoObject200 would also be a layer
// of CryptoObject.
void checkCryptomatteTypes(const std::vector<Layer>& layers) {
  for (const Layer& a : layers)
    for (const Layer& b : layers) {
      if (&a == &b || a.source != Layer::Source::coverage || b.source != Layer::Source::coverage) continue;
      const std::string type = cryptomatteType(a.name), other = cryptomatteType(b.name);
      if (other.starts_with(type) && other.find_first_not_of("0123456789", type.size()) == other.npos)
        throw UsageError(
            fmt::format("layers '{}' and '{}' cannot be in one file: readers of Cryptomatte cannot distinguish "
                        "names that differ only in digits at the end",
                        a.name, b.name));
    }
}

io::Image sampleCounts(const job::RenderResult& result) {
  const render::Region& region = result.provenance.region;
  const render::SampleCounts counts = result.film->counts();
  io::Image image = io::makeImage(region.width, region.height, 1, io::PixelType::f32, io::ColorEncoding::linear);
  const std::span<float> values = image.samples<float>();
  render::FilmState cells;
  cells.region = region;
  for (std::uint32_t y = 0; y < region.height; ++y)
    for (std::uint32_t x = 0; x < region.width; ++x)
      values[std::size_t{y} * region.width + x] = static_cast<float>(counts.samplesOf(cells.cellOf(x, y)));
  return image;
}

bool isName(const std::string& text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

// True if the film has the data that the layer is made from.
bool isStored(const job::FilmView& film, const Layer& layer) {
  if (layer.source == Layer::Source::sampleCount || layer.source == Layer::Source::variance) return true;
  if (layer.output >= film.planes().size() || !film.stores(layer.output)) return false;
  const bool counts = film.planes()[layer.output].pixel == OutputPixel::coverage;
  return counts == (layer.source == Layer::Source::coverage);
}

Layer parseLayer(const nlohmann::json& json, const job::FilmView& film) {
  Layer layer;
  layer.name = json.at("name").get<std::string>();
  layer.channels = json.at("channels").get<std::vector<std::string>>();
  layer.exact = json.at("exact").get<bool>();
  const auto source = json.at("source").get<unsigned>();
  layer.output = json.at("output").get<std::size_t>();
  layer.source = static_cast<Layer::Source>(std::min(source, static_cast<unsigned>(Layer::Source::sampleCount)));
  const bool named = layer.source == Layer::Source::coverage || std::ranges::all_of(layer.channels, isName);
  if (!isName(layer.name) || !named || source > static_cast<unsigned>(layer.source) || !isStored(film, layer))
    throw UsageError("the layers of the film do not match its outputs");
  return layer;
}

}  // namespace

std::vector<Layer> availableLayers(const program::Program& program) {
  std::vector<Layer> layers;
  for (std::size_t output = 1; output < program.outputs.size(); ++output) layers.push_back(layerOf(program, output));
  if (program.accumulation != program::Accumulation::film) return layers;
  const auto offer = [&](Layer layer) {
    if (std::ranges::find(program.outputs, layer.name, &program::Output::name) == program.outputs.end())
      layers.push_back(std::move(layer));
  };
  offer({"variance",
         "Variance of the image's mean, per channel; infinite below two batches",
         {"R", "G", "B"},
         true,
         Layer::Source::variance,
         0});
  offer({"sample_count", "Number of samples of the pixel", {"X"}, true, Layer::Source::sampleCount, 0});
  return layers;
}

std::vector<Layer> selectLayers(const std::vector<Layer>& available, const std::vector<std::string>& names,
                                const std::string& owner, const std::vector<std::string>& alsoSuggested) {
  if (std::ranges::find(names, "all") != names.end()) return available;
  std::vector<std::string> known;
  std::vector<Layer> selected;
  for (const Layer& layer : available) {
    known.push_back(layer.name);
    if (std::ranges::find(names, layer.name) != names.end()) selected.push_back(layer);
  }
  std::vector<std::string> similar = known;
  similar.insert(similar.end(), alsoSuggested.begin(), alsoSuggested.end());
  for (const std::string& name : names)
    if (std::ranges::find(known, name) == known.end())
      throw UsageError(fmt::format("layer '{}' not found in {}{}; available: {}", printable(name), owner,
                                   suggestion(name, similar),
                                   known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "))));
  return selected;
}

void checkChannels(const std::vector<Layer>& layers) {
  std::map<std::string, std::string> owners;  // of channels
  for (const Layer& layer : layers)
    for (const std::string& channel : fileChannels(layer))
      if (const auto [at, isNew] = owners.emplace(channel, layer.name); !isNew)
        throw UsageError(fmt::format("layers '{}' and '{}' would both be the channel {} of the file", at->second,
                                     layer.name, channel));
  checkCryptomatteTypes(layers);
}

std::string layerList(const program::Program& program) {
  std::string text;
  for (const Layer& layer : availableLayers(program::withAllHeatMaps(program)))
    text +=
        fmt::format("{:<22} {:<26} {}\n", layer.name, fmt::format("{}", fmt::join(layer.channels, " ")), layer.help);
  return text;
}

std::size_t channelCount(const std::vector<Layer>& layers, std::size_t imageChannels) {
  std::size_t count = imageChannels;
  for (const Layer& layer : layers) count += fileChannels(layer).size();
  return count;
}

std::string layersText(const std::vector<Layer>& layers) {
  if (layers.empty()) return "";
  nlohmann::json list = nlohmann::json::array();
  for (const Layer& layer : layers) {
    const bool ofOutput = layer.source == Layer::Source::output || layer.source == Layer::Source::coverage;
    const std::size_t order = ofOutput ? layer.output : 1'000'000 + static_cast<std::size_t>(layer.source);
    list.push_back({{"name", layer.name},
                    {"channels", layer.channels},
                    {"exact", layer.exact},
                    {"source", static_cast<unsigned>(layer.source)},
                    {"output", layer.output},
                    {"order", order}});
  }
  return list.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::vector<Layer> parseLayers(const std::string& text, const job::FilmView& film) {
  if (text.empty()) return {};
  try {
    std::vector<Layer> layers;
    for (const nlohmann::json& layer : parseJson(text)) layers.push_back(parseLayer(layer, film));
    checkChannels(layers);
    return layers;
  } catch (const nlohmann::json::exception&) {
    throw UsageError("the layers of the film cannot be read");
  }
}

void addChannels(io::ExrImage& image, const std::string& layer, const std::vector<std::string>& suffixes,
                 const io::Image& pixels, io::ExrType colors, bool exact) {
  const std::span<const float> samples = pixels.samples<float>();
  for (std::size_t c = 0; c < suffixes.size() && c < pixels.channels; ++c) {
    io::ExrChannel& channel = image.channels.emplace_back();
    channel.name = layer.empty() ? suffixes[c] : layer + "." + suffixes[c];
    channel.type = exact ? io::ExrType::f32 : colors;
    channel.exact = exact;
    channel.samples.resize(pixels.pixelCount());
    for (std::size_t i = 0; i < channel.samples.size(); ++i) channel.samples[i] = samples[i * pixels.channels + c];
  }
}

void addLayer(io::ExrImage& image, const Layer& layer, const job::RenderResult& result, io::ExrType colors) {
  switch (layer.source) {
    case Layer::Source::output:
      return addChannels(image, layer.name, layer.channels, result.film->image(layer.output), colors, layer.exact);
    case Layer::Source::variance:
      return addChannels(image, layer.name, layer.channels, result.film->variance(), colors, true);
    case Layer::Source::sampleCount:
      return addChannels(image, layer.name, layer.channels, sampleCounts(result), colors, true);
    case Layer::Source::coverage: return addCryptomatte(image, layer.name, layer.output, result);
  }
}

}  // namespace quintet::output
