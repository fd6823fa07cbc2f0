// SPDX-License-Identifier: Apache-2.0
// Images and films of the public API: pixels, layers, files.
#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "api/impl.h"
#include "base/error.h"
#include "base/file.h"
#include "base/plural.h"
#include "base/suggestion.h"
#include "io/codec.h"
#include "job/film_store.h"
#include "job/merge.h"
#include "output/write.h"
#include "render/tone_map/tone_map.h"

namespace quintet {
namespace {

io::Image toIoImage(const Image& image) {
  const std::size_t expected = std::size_t{4} * image.width * image.height;
  if (image.pixels.size() != expected)
    throw UsageError(fmt::format("an image of {}x{} has {} floats, not {}", image.width, image.height, expected,
                                 image.pixels.size()));
  io::Image result = io::makeImage(image.width, image.height, 4, io::PixelType::f32, io::ColorEncoding::linear);
  result.premultiplied = true;
  std::memcpy(result.data.data(), image.pixels.data(), result.data.size());
  return result;
}

// The library writes files only.
output::FileKind fileKind(const std::filesystem::path& file) {
  if (output::isStandardOutput(file))
    throw UsageError(fmt::format("{}: this name means standard output, which the library does not use", file.string()));
  return output::fileKind(file);
}

// The layers of the film besides the image: those that it names, and what every film knows.
std::vector<output::Layer> storedLayers(const job::RenderResult& result) {
  std::vector<output::Layer> layers = output::parseLayers(result.provenance.layers, *result.film);
  program::Program none;  // offers the layers that do not depend on the program
  none.outputs.resize(1);
  for (output::Layer& layer : output::availableLayers(none))
    if (std::ranges::find(layers, layer.name, &output::Layer::name) == layers.end()) layers.push_back(std::move(layer));
  return layers;
}

}  // namespace

std::array<float, 4> Image::at(std::uint32_t x, std::uint32_t y) const {
  if (x >= width || y >= height)
    throw UsageError(fmt::format("pixel ({}, {}) is outside of the image of {}x{}", x, y, width, height));
  const float* p = &pixels[4 * (std::size_t{y} * width + x)];
  return {p[0], p[1], p[2], p[3]};
}

void Image::write(const std::filesystem::path& file) const {
  const render::ToneMap operation = toneMap ? render::ToneMap::neutral : render::ToneMap::linear;
  switch (fileKind(file)) {
    case output::FileKind::png:
      return writeFile(file, io::encodePng(render::toDisplay(toIoImage(*this), operation, 0.0f, true), {}));
    case output::FileKind::exr: return writeFile(file, io::encodeExr(toIoImage(*this), {}));
    case output::FileKind::hdr: return writeFile(file, io::encodeHdr(toIoImage(*this)));
    case output::FileKind::film: break;
  }
  throw UsageError(fmt::format("{}: an image is not a film; use Film::write()", file.string()));
}

Image toImage(const job::FilmView& film, const std::string& output) {
  const std::vector<render::FilmPlane>& planes = film.planes();
  std::vector<std::string> names;
  for (const render::FilmPlane& plane : planes) names.push_back(plane.name);
  const auto found = output.empty() ? names.begin() : std::ranges::find(names, output);
  if (found == names.end()) throw UsageError(fmt::format("output '{}' not found{}", output, suggestion(output, names)));
  const auto index = static_cast<std::size_t>(found - names.begin());
  if (!film.stores(index))
    throw UsageError(fmt::format("output '{}' was not rendered; name it in Settings::outputs", *found));
  const io::Image image = film.image(index);
  const std::span<const float> samples = image.samples<float>();
  return {
      image.width, image.height, {samples.begin(), samples.end()}, planes[index].kind == program::OutputKind::color};
}

Film Film::Impl::make(job::RenderResult result, std::vector<output::Layer> layers) {
  Film film;
  film.impl_ = std::make_shared<const Impl>(Impl{std::move(result), std::move(layers)});
  return film;
}

const Film::Impl& Film::impl() const { return requireObject(impl_, "Film"); }

Film Film::load(const std::filesystem::path& file, std::size_t maxMemory) { return merge({file}, maxMemory); }

Film Film::merge(const std::vector<std::filesystem::path>& parts, std::size_t maxMemory) {
  job::Observer ignored;
  job::RenderResult result = job::merge(parts, ignored, {}, maxMemory);
  std::vector<output::Layer> layers = storedLayers(result);
  return Impl::make(std::move(result), std::move(layers));
}

std::uint32_t Film::width() const { return impl().result.provenance.region.width; }
std::uint32_t Film::height() const { return impl().result.provenance.region.height; }

double Film::sampleCount() const {
  const job::RenderResult& result = impl().result;
  if (result.accumulatesFrames) return static_cast<double>(result.provenance.samples);
  return render::averageSamples(result.provenance.region, result.film->counts());
}

std::vector<std::string> Film::layers() const {
  std::vector<std::string> names;
  for (const output::Layer& layer : impl().layers) names.push_back(layer.name);
  return names;
}

Image Film::image(const std::string& output) const { return toImage(*impl().result.film, output); }

Layer Film::layer(const std::string& name) const {
  const std::vector<render::FilmPlane>& planes = impl().result.film->planes();
  if (!planes.empty() && name == planes.front().name) {  // the image, under its name
    Image color = image();
    return {name, color.width, color.height, {"R", "G", "B", "A"}, std::move(color.pixels), {}};
  }
  const output::Layer selected = output::selectLayers(impl().layers, {name}, "the film").front();
  io::ExrImage channels{width(), height(), {}};
  output::addLayer(channels, selected, impl().result, io::ExrType::f32);
  Layer layer{name, width(), height(), {}, {}, {}};
  const std::size_t count = channels.channels.size();
  const std::size_t pixels = std::size_t{layer.width} * layer.height;
  layer.values.resize(count * pixels);
  for (std::size_t c = 0; c < count; ++c) {
    const io::ExrChannel& channel = channels.channels[c];
    const bool prefixed = channel.name.starts_with(name + ".");
    layer.channels.push_back(prefixed ? channel.name.substr(name.size() + 1) : channel.name);
    for (std::size_t i = 0; i < pixels; ++i) layer.values[i * count + c] = channel.samples[i];
  }
  const bool isId = selected.source == output::Layer::Source::output &&
                    impl().result.film->planes()[selected.output].kind == program::OutputKind::id;
  if (isId) {
    for (const float value : layer.values) layer.ids.push_back(static_cast<std::uint32_t>(value));
    layer.values.clear();
  }
  return layer;
}

std::vector<std::pair<std::string, std::string>> Film::metadata() const {
  return job::metadataOf(impl().result.provenance);
}

void Film::write(const std::filesystem::path& file, const WriteOptions& options) const {
  output::OutputPlan plan;
  plan.kind = fileKind(file);
  plan.request.file = file;
  plan.request.layers = options.layers;
  if (plan.kind == output::FileKind::png) plan.request.pngBits = options.pngBits;
  if (plan.kind == output::FileKind::exr && options.floats) plan.request.exr = output::ExrFormat{io::ExrType::f32, {}};
  plan.request.exposure = options.exposure;
  output::checkMergeRequest(plan.request);
  if (plan.kind == output::FileKind::film && impl().result.accumulatesFrames)
    throw UsageError(
        fmt::format("{}: the program averages its samples itself, so there is no film to store", file.string()));
  if (!options.toneMap.empty()) {
    plan.request.toneMap = render::toneMapByName(options.toneMap);
    if (!plan.request.toneMap)
      throw UsageError(fmt::format("tone map '{}' not found{}", options.toneMap,
                                   suggestion(options.toneMap, render::toneMapNames())));
  }
  plan.outputs = {0};
  plan.layers = output::selectLayers(impl().layers, options.layers, "the film");
  output::checkChannels(plan.layers);
  output::checkSize(plan, {width(), height()});
  job::Observer ignored;
  output::writeOutputs(plan, impl().result, ignored);
}

}  // namespace quintet
