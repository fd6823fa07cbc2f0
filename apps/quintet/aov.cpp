#include "aov.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "aov_cryptomatte.h"
#include "base/error.h"
#include "exr_output.h"
#include "io/cryptomatte.h"
#include "values.h"

namespace quintet::app {
namespace {

using program::OutputPixel;

AovLayer layerOf(const program::Program& program, std::size_t output) {
  const program::Output& description = program.outputs[output];
  AovLayer layer{
      description.name, description.help, program::outputChannels(description), true, AovLayer::Source::output, output};
  layer.exact = !program::holdsColor(description);
  if (description.pixel == OutputPixel::coverage) {
    layer.source = AovLayer::Source::coverage;
    layer.channels = {cryptomatteType(description.name) + "00-" + fmt::format("{:02}", kCryptomatteLayers - 1), "RGBA"};
    layer.exact = true;
  }
  return layer;
}

std::vector<std::string> namesOf(const std::vector<AovLayer>& layers) {
  std::vector<std::string> names;
  for (const AovLayer& layer : layers) names.push_back(layer.name);
  return names;
}

// As the file names them.
std::vector<std::string> fileChannels(const AovLayer& layer) {
  std::vector<std::string> names;
  if (layer.source == AovLayer::Source::coverage) {
    for (std::size_t i = 0; i < 4 * kCryptomatteLayers; ++i)
      names.push_back(io::cryptomatteChannel(cryptomatteType(layer.name), i / 2, i % 2 == 1));
  } else {
    for (const std::string& suffix : layer.channels) names.push_back(layer.name + "." + suffix);
  }
  return names;
}

// Readers of Cryptomatte take as layers of a type what is its name and digits: CryptoObject2's 00 would be a layer of
// CryptoObject, too.
void checkTypes(const std::vector<AovLayer>& layers) {
  for (const AovLayer& a : layers)
    for (const AovLayer& b : layers) {
      if (&a == &b || a.source != AovLayer::Source::coverage || b.source != AovLayer::Source::coverage) continue;
      const std::string type = cryptomatteType(a.name), other = cryptomatteType(b.name);
      if (other.starts_with(type) && other.find_first_not_of("0123456789", type.size()) == other.npos)
        throw UsageError(
            fmt::format("--aov: the layers of '{}' would be taken for some of '{}': names of what is "
                        "counted must differ in more than digits at the end",
                        b.name, a.name));
    }
}

io::Image sampleCounts(const AovSource& source) {
  const render::Region& region = source.region;
  io::Image image = io::makeImage(region.width, region.height, 1, io::PixelType::f32, io::ColorEncoding::linear);
  const std::span<float> values = image.samples<float>();
  render::FilmState cells;
  cells.region = region;
  for (std::uint32_t y = 0; y < region.height; ++y)
    for (std::uint32_t x = 0; x < region.width; ++x)
      values[std::size_t{y} * region.width + x] = static_cast<float>(source.counts.samplesOf(cells.cellOf(x, y)));
  return image;
}

}  // namespace

std::vector<AovLayer> aovLayers(const program::Program& program) {
  std::vector<AovLayer> layers;
  for (std::size_t output = 1; output < program.outputs.size(); ++output) layers.push_back(layerOf(program, output));
  if (program.accumulation != program::Accumulation::film) return layers;
  const auto offer = [&](const char* name, const char* help, std::vector<std::string> channels,
                         AovLayer::Source source) {
    const bool taken = std::ranges::any_of(program.outputs, [&](const program::Output& o) { return o.name == name; });
    if (!taken) layers.push_back({name, help, std::move(channels), true, source, 0});
  };
  offer("variance", "Of the picture's mean, per channel; infinite below two batches", {"R", "G", "B"},
        AovLayer::Source::variance);
  offer("sample_count", "Samples of the pixel", {"X"}, AovLayer::Source::sampleCount);
  return layers;
}

std::vector<AovLayer> chooseAovs(const program::Program& program, const std::vector<std::string>& names) {
  return chooseAovs(aovLayers(program), names, fmt::format("the program '{}' has", program.name));
}

std::vector<AovLayer> chooseAovs(const std::vector<AovLayer>& layers, const std::vector<std::string>& names,
                                 const std::string& none) {
  if (std::ranges::find(names, "all") != names.end()) return layers;
  std::vector<AovLayer> chosen;
  for (const AovLayer& layer : layers)
    if (std::ranges::find(names, layer.name) != names.end()) chosen.push_back(layer);
  const std::vector<std::string> known = namesOf(layers);
  for (const std::string& name : names)
    if (std::ranges::find(known, name) == known.end())
      throw UsageError(fmt::format("--aov: {} no layer '{}'{}; there are {}", none, plain(name),
                                   suggestion(name, known),
                                   known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "))));
  return chosen;
}

void checkChannels(const std::vector<AovLayer>& layers) {
  std::map<std::string, std::string> owners;  // of channels
  for (const AovLayer& layer : layers)
    for (const std::string& channel : fileChannels(layer))
      if (const auto [at, isNew] = owners.emplace(channel, layer.name); !isNew)
        throw UsageError(fmt::format("--aov: '{}' and '{}' would both be the channel {} of the file", at->second,
                                     layer.name, channel));
  checkTypes(layers);
}

std::string aovList(const program::Program& program) {
  std::string text;
  for (const AovLayer& layer : aovLayers(program))
    text +=
        fmt::format("{:<22} {:<26} {}\n", layer.name, fmt::format("{}", fmt::join(layer.channels, " ")), layer.help);
  return text;
}

std::size_t channelCount(const std::vector<AovLayer>& layers, std::size_t first) {
  std::size_t count = first;
  for (const AovLayer& layer : layers) count += fileChannels(layer).size();
  return count;
}

AovSource aovSource(const render::Renderer& renderer) {
  const render::Film& film = renderer.film();
  return {film.region(), film.counts(), [&](std::size_t output) { return renderer.image(output); },
          [&](std::size_t output) { return film.plane(output); },
          [&] { return render::varianceImage(film.saveFirst()); }};
}

AovSource aovSource(const render::FilmState& film) {
  return {film.region, film.counts, [&](std::size_t output) { return render::planeImage(film, output); },
          [&](std::size_t output) { return film.planes.at(output); }, [&] { return render::varianceImage(film); }};
}

void addAov(io::ExrPicture& picture, const AovLayer& layer, const AovSource& source, const CoverageNames& names,
            io::ExrType colors) {
  switch (layer.source) {
    case AovLayer::Source::output:
      return addLayer(picture, layer.name, layer.channels, source.image(layer.output), colors, layer.exact);
    case AovLayer::Source::variance:
      return addLayer(picture, layer.name, layer.channels, source.variance(), colors, true);
    case AovLayer::Source::sampleCount:
      return addLayer(picture, layer.name, layer.channels, sampleCounts(source), colors, true);
    case AovLayer::Source::coverage: return addCryptomatte(picture, layer, source, names);
  }
}

}  // namespace quintet::app
