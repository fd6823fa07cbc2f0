#include "film_pictures.h"

#include <array>

#include "exr_output.h"
#include "film_facts.h"
#include "output.h"
#include "picture_names.h"
#include "values.h"

namespace quintet::app {
namespace {

using render::FilmFile;

float exposureOf(const FilmFile& file) {
  const std::string text = factText(file.notes, "exposure");
  return text.empty() ? 0.0f : static_cast<float>(parseNumber("exposure", text, -100.0, 100.0));
}

program::OutputKind kindOf(const FilmFile& file, const std::string& output) {
  const std::string name = factText(file.notes, "kind of " + output);
  for (int kind = 0; kind < static_cast<int>(program::OutputKind::display); ++kind)
    if (program::outputKindName(static_cast<program::OutputKind>(kind)) == name) return static_cast<program::OutputKind>(kind);
  return program::OutputKind::display;
}

DisplayOptions displayOptions(const FilmFile& file, const MergeOptions& options, program::OutputKind kind) {
  DisplayOptions display;
  display.toneMap = kind == program::OutputKind::color ? render::ToneMap::neutral : render::ToneMap::linear;
  if (const auto rendered = render::toneMapByName(factText(file.notes, "tone map"))) display.toneMap = *rendered;
  if (options.render.toneMap) display.toneMap = *options.render.toneMap;
  display.exposure = options.exposureGiven ? options.render.exposure : exposureOf(file);
  display.opaque = factText(file.identity, "transparent") != "yes";
  return display;
}

std::vector<std::byte> exrFile(const io::Image& image, program::OutputKind kind, const ExrFormat& format,
                               const RenderRecord& record) {
  const auto& [x, y, width, height] = record.region;
  io::ExrPicture picture = exrPicture({x, y, width, height}, record.width, record.height, metadata(record));
  const bool isColor = kind == program::OutputKind::color || kind == program::OutputKind::display;
  addBeauty(picture, image, record.transparent, format.colors, !isColor);
  return io::encodeExr(picture, format.options);
}

}  // namespace

void writePictures(const FilmFile& file, const MergeOptions& options, RenderRecord& record) {
  const bool all = options.render.allOutputs || factText(file.notes, "all outputs") == "yes";
  for (std::size_t i = 0; i < file.film.planes.size(); ++i) {
    const render::FilmPlane& plane = file.film.planes[i];
    if ((i > 0 && !all) || !plane.stored() || plane.pixel == program::OutputPixel::coverage) continue;
    const program::OutputKind kind = kindOf(file, plane.name);
    io::Image image = render::planeImage(file.film, i);
    const DisplayOptions display = displayOptions(file, options, kind);
    if (kind == program::OutputKind::display) render::decodeDisplay(image, !display.opaque);
    const std::filesystem::path path = pictureName(options.render.output, all ? plane.name : "", std::nullopt);
    record.toneMap = outputKind(path) == OutputKind::png ? render::toneMapNames()[static_cast<std::size_t>(display.toneMap)] : "";
    record.exposure = display.exposure;
    record.outputName = plane.name;
    record.files.push_back(path.string());
    if (outputKind(path) == OutputKind::exr)
      writeBytes(path, exrFile(image, kind, options.render.exr, record));
    else
      writePicture(path, image, display, metadata(record));
  }
}

}  // namespace quintet::app
