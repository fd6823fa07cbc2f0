// SPDX-License-Identifier: Apache-2.0
#include "output/write.h"

#include <optional>
#include <string>

#include "io/codec.h"
#include "job/film_store.h"
#include "output/file_names.h"
#include "output/frame_files.h"
#include "render/tone_map/false_color.h"

namespace quintet::output {
namespace {

// The provenance of one image.
job::Provenance provenanceOf(const job::RenderResult& result, const std::string& output) {
  job::Provenance provenance = result.provenance;
  provenance.output = output;
  provenance.exposure.reset();
  provenance.toneMap.clear();
  return provenance;
}

render::ToneMap toneMapOf(const OutputPlan& plan, const render::FilmPlane& plane) {
  return plan.request.toneMap.value_or(render::defaultToneMap(plane.kind));
}

// Unless a tone map was requested.
bool hasFalseColors(const OutputPlan& plan, const render::FilmPlane& plane) {
  return plane.kind == program::OutputKind::heat && !plan.request.toneMap;
}

std::string toneMapName(const OutputPlan& plan, const render::FilmPlane& plane) {
  if (hasFalseColors(plan, plane)) return "viridis";
  return render::toneMapNames()[static_cast<std::size_t>(toneMapOf(plan, plane))];
}

io::Image falseColors(const io::Image& image, float exposure, bool legend, unsigned bits) {
  return render::falseColor(image, {.scale = render::falseColorScale(image, exposure), .legend = legend, .bits = bits});
}

// The metadata of an image; with the hash of the frame if it is complete.
io::Metadata metadataOf(const OutputPlan& plan, const job::RenderResult& result, const job::Provenance& provenance) {
  io::Metadata metadata = job::metadataOf(provenance);
  if (plan.request.everyFrame && result.provenance.frame && !result.interrupted && !result.accumulatesFrames)
    metadata.emplace_back(kFrameHashKey, frameHash(plan, result.provenance));
  return metadata;
}

std::vector<std::byte> encodePng(const OutputPlan& plan, const job::RenderResult& result, std::size_t output) {
  const render::FilmPlane& plane = result.film->planes()[output];
  const double exposure = plan.request.exposure.value_or(0.0);
  job::Provenance provenance = provenanceOf(result, plane.name);
  provenance.toneMap = toneMapName(plan, plane);
  provenance.exposure = exposure;
  const io::Image image = result.film->image(output);
  const auto stops = static_cast<float>(exposure);
  const unsigned bits = plan.request.pngBits.value_or(8);
  return io::encodePng(hasFalseColors(plan, plane) ? falseColors(image, stops, true, bits)
                                                   : render::toDisplay(image, toneMapOf(plan, plane), stops,
                                                                       !result.provenance.transparent, bits),
                       metadataOf(plan, result, provenance));
}

std::vector<std::byte> encodeExr(const OutputPlan& plan, const job::RenderResult& result, std::size_t output) {
  const job::Provenance& p = result.provenance;
  const render::FilmPlane& plane = result.film->planes()[output];
  const ExrFormat format = plan.request.exr.value_or(ExrFormat());
  io::ExrImage image;
  image.width = p.region.width;
  image.height = p.region.height;
  image.window = {p.region.x, p.region.y, p.size.x, p.size.y};
  image.metadata = metadataOf(plan, result, provenanceOf(result, plane.name));
  // As OpenEXR's standard attributes describe them (ImfStandardAttributes.h).
  if (plane.color) image.attributes.push_back({"chromaticities", io::ExrChromaticities()});
  if (p.framesPerSecond) image.attributes.push_back({"framesPerSecond", io::exrFrameRate(*p.framesPerSecond)});
  if (p.worldToCamera && p.worldToNdc) {
    image.attributes.push_back({"worldToCamera", *p.worldToCamera});
    image.attributes.push_back({"worldToNDC", *p.worldToNdc});
  }
  std::vector<std::string> channels{"R", "G", "B"};
  if (p.transparent) channels.push_back("A");
  addChannels(image, "", channels, result.film->image(output), format.colors, !plane.color);
  if (!plan.request.allOutputs)
    for (const Layer& layer : plan.layers) addLayer(image, layer, result, format.colors);
  return io::encodeExr(image, format.options);
}

}  // namespace

std::vector<WrittenFile> writeOutputs(const OutputPlan& plan, const job::RenderResult& result,
                                      job::Observer& observer) {
  const std::filesystem::path& file = plan.request.file;
  const bool toStandardOutput = isStandardOutput(file);
  observer.stage("writing " + (toStandardOutput ? "standard output" : file.string()));
  if (plan.kind == FileKind::film) {
    observer.write(file, render::encodeFilm(job::filmFileOf(result)));
    return {{file, ""}};
  }
  std::optional<std::uint64_t> frame;
  if (plan.request.everyFrame) frame = result.provenance.frame;
  if (plan.request.everyFrame && !frame && hasFramePattern(file)) frame = 0;
  std::vector<WrittenFile> written;
  for (const std::size_t output : plan.outputs) {
    const render::FilmPlane& plane = result.film->planes()[output];
    WrittenFile& entry = written.emplace_back();
    entry.path = toStandardOutput ? "-" : fileName(file, plan.request.allOutputs ? plane.name : "", frame);
    if (plan.kind == FileKind::png) {
      entry.toneMap = toneMapName(plan, plane);
      observer.write(entry.path, encodePng(plan, result, output));
    } else if (plan.kind == FileKind::exr) {
      observer.write(entry.path, encodeExr(plan, result, output));
    } else {
      observer.write(entry.path, io::encodeHdr(result.film->image(output)));
    }
  }
  return written;
}

io::Image displayImage(const OutputPlan& plan, const job::FilmView& film) {
  const std::size_t output = plan.outputs.front();
  const render::FilmPlane& plane = film.planes()[output];
  const auto exposure = static_cast<float>(plan.request.exposure.value_or(0.0));
  if (hasFalseColors(plan, plane)) return falseColors(film.image(output), exposure, false, 8);
  return render::toDisplay(film.image(output), toneMapOf(plan, plane), exposure, true);
}

void addWritten(std::vector<WrittenFile>& files, const std::vector<WrittenFile>& more) {
  for (const WrittenFile& file : more) {
    std::erase_if(files, [&](const WrittenFile& known) { return known.path == file.path; });
    files.push_back(file);
  }
}

void checkFilmLoss(const OutputPlan& plan, const job::RenderResult& result, std::size_t maxMemory) {
  if (plan.kind != FileKind::film) return;
  job::rejectLoss(plan.request.file, job::toFacts(result.provenance, job::ProvenanceField::Role::identity),
                  result.film->counts(), maxMemory);
}

}  // namespace quintet::output
