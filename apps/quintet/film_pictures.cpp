#include "film_pictures.h"

#include <array>

#include "aov_notes.h"
#include "exr_camera.h"
#include "exr_output.h"
#include "film_facts.h"
#include "output.h"
#include "picture_names.h"
#include "values.h"

namespace quintet::app {
namespace {

using render::FilmFile;

program::OutputKind kindOf(const FilmFile& file, const std::string& output) {
  const std::string name = factText(file.notes, "kind of " + output);
  for (int kind = 0; kind < static_cast<int>(program::OutputKind::display); ++kind)
    if (program::outputKindName(static_cast<program::OutputKind>(kind)) == name)
      return static_cast<program::OutputKind>(kind);
  return program::OutputKind::display;
}

DisplayOptions displayOptions(const FilmFile& file, const MergeOptions& options, program::OutputKind kind) {
  DisplayOptions display;
  display.toneMap = kind == program::OutputKind::color ? render::ToneMap::neutral : render::ToneMap::linear;
  if (const auto rendered = render::toneMapByName(factText(file.notes, kToneMapFact))) display.toneMap = *rendered;
  if (options.render.toneMap) display.toneMap = *options.render.toneMap;
  display.exposure = options.exposureGiven ? options.render.exposure : exposureOf(file);
  display.opaque = factText(file.identity, "transparent") != "yes";
  return display;
}

// Of the layers that were rendered, those that were asked for now; all of them, if none were.
std::vector<AovLayer> chosenLayers(const FilmFile& file, const MergeOptions& options) {
  std::vector<AovLayer> layers = readAovLayers(file.notes, file.film);
  if (!options.render.aovs.empty()) layers = chooseAovs(layers, options.render.aovs, "in these films there is");
  return layers;
}

io::Image imageOf(const FilmFile& file, std::size_t output) {
  io::Image image = render::planeImage(file.film, output);
  const bool opaque = factText(file.identity, "transparent") != "yes";
  if (kindOf(file, file.film.planes[output].name) == program::OutputKind::display)
    render::decodeDisplay(image, !opaque);
  return image;
}

std::vector<std::byte> exrFile(const FilmFile& file, std::size_t output, const MergeOptions& options,
                               const RenderRecord& record) {
  const auto& [x, y, width, height] = record.region;
  const ExrFormat& format = options.render.exr;
  io::ExrPicture picture = exrPicture({x, y, width, height}, record.width, record.height, metadata(record));
  addCamera(picture, readCameraNotes(file.notes));
  const bool isColor = factText(file.notes, "colour in " + file.film.planes[output].name) == "yes";
  addBeauty(picture, imageOf(file, output), record.transparent, format.colors, !isColor);
  if (options.render.allOutputs) return io::encodeExr(picture, format.options);
  AovSource source = aovSource(file.film);
  source.image = [&](std::size_t other) { return imageOf(file, other); };
  const CoverageNames names = readCoverageNames(file.notes);
  for (const AovLayer& layer : chosenLayers(file, options)) addAov(picture, layer, source, names, format.colors);
  return io::encodeExr(picture, format.options);
}

}  // namespace

float exposureOf(const FilmFile& file) {
  const std::string text = factText(file.notes, kExposureFact);
  return text.empty() ? 0.0f : static_cast<float>(parseNumber("exposure", text, -100.0, 100.0));
}

void keepShown(FilmFile& file, const MergeOptions& options) {
  const RenderOptions& render = options.render;
  if (options.exposureGiven) setFact(file.notes, kExposureFact, exposureText(render.exposure));
  if (render.toneMap) setFact(file.notes, kToneMapFact, toneMapText(render.toneMap));
  if (render.allOutputs) setFact(file.notes, kAllOutputsFact, "yes");
}

void checkShown(const FilmFile& file) {
  exposureOf(file);
  readAovLayers(file.notes, file.film);
  readCoverageNames(file.notes);
  readCameraNotes(file.notes);
}

bool showsAllOutputs(const FilmFile& file, const MergeOptions& options) {
  return options.render.allOutputs || factText(file.notes, kAllOutputsFact) == "yes";
}

void writePictures(const FilmFile& file, const MergeOptions& options, RenderRecord& record) {
  const bool all = showsAllOutputs(file, options);
  for (std::size_t i = 0; i < file.film.planes.size(); ++i) {
    const render::FilmPlane& plane = file.film.planes[i];
    if ((i > 0 && !all) || !plane.stored() || plane.pixel == program::OutputPixel::coverage) continue;
    const program::OutputKind kind = kindOf(file, plane.name);
    const DisplayOptions display = displayOptions(file, options, kind);
    const std::filesystem::path path = pictureName(options.render.output, all ? plane.name : "", std::nullopt);
    record.toneMap =
        outputKind(path) == OutputKind::png ? render::toneMapNames()[static_cast<std::size_t>(display.toneMap)] : "";
    record.exposure = display.exposure;
    record.outputName = plane.name;
    record.files.push_back(path.string());
    if (outputKind(path) == OutputKind::exr)
      writeBytes(path, exrFile(file, i, options, record));
    else
      writePicture(path, imageOf(file, i), display, metadata(record));
  }
}

}  // namespace quintet::app
