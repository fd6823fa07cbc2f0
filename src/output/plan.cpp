// SPDX-License-Identifier: Apache-2.0
#include "output/plan.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/file.h"
#include "base/plural.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "output/file_names.h"
#include "program/heat.h"

namespace quintet::output {
namespace {

// Rules that need neither program nor film.
FileKind checkRequest(const OutputRequest& request) {
  const FileKind kind = fileKind(request.file);
  if (!request.layers.empty() && request.allOutputs)
    throw UsageError("layers (one file) and all outputs (one file each) exclude each other");
  if (!request.layers.empty() && !request.output.empty())
    throw UsageError("layers and a selected output exclude each other: layers accompany the program's first output");
  if (!request.output.empty() && request.allOutputs)
    throw UsageError("a selected output and all outputs exclude each other");
  if (!request.layers.empty() && kind != FileKind::exr && kind != FileKind::film)
    throw UsageError(fmt::format("{}: only OpenEXR files have layers; use the extension .exr", request.file.string()));
  if (request.exr && kind != FileKind::exr)
    throw UsageError(fmt::format("{}: OpenEXR options require the extension .exr", request.file.string()));
  if (request.pngBits && kind != FileKind::png)
    throw UsageError(fmt::format("{}: the number of bits applies to PNG only", request.file.string()));
  if (request.pngBits && *request.pngBits != 8 && *request.pngBits != 16)
    throw UsageError(fmt::format("{} per channel: PNG files have 8 or 16", counted(*request.pngBits, "bit")));
  if (request.exposure && !(std::abs(*request.exposure) <= kMaxExposure))
    throw UsageError(
        fmt::format("exposure {}: must be {} to {} stops", *request.exposure, -kMaxExposure, kMaxExposure));
  if (isStandardOutput(request.file)) {
    if (kind == FileKind::film) throw UsageError("standard output takes an image, not a film");
    if (request.allOutputs || request.everyFrame)
      throw UsageError("standard output takes one image, not several files");
  }
  checkWritable(isStandardOutput(request.file) ? "-" : request.file);
  return kind;
}

// Files that the plan writes are writable. Frames share a folder, so only files that exist can fail after the first.
void checkFiles(const OutputPlan& plan, const std::vector<std::string>& names, const job::FrameRequest& frames) {
  const OutputRequest& request = plan.request;
  if (plan.kind == FileKind::film || isStandardOutput(request.file)) return;
  if (!request.allOutputs && !request.everyFrame) return;
  const std::uint64_t first = frames.firstFrame(), last = request.everyFrame ? frames.lastFrame() : first;
  for (const std::size_t output : plan.outputs)
    for (std::uint64_t frame = first; frame <= last; ++frame) {
      const std::filesystem::path file = fileName(request.file, request.allOutputs ? names[output] : "",
                                                  request.everyFrame ? std::optional(frame) : std::nullopt);
      std::error_code ignored;
      if (frame == first || std::filesystem::exists(file, ignored)) checkWritable(file);
    }
}

std::vector<std::size_t> selectOutputs(const OutputRequest& request, const program::Program& program) {
  const std::vector<std::string> names = program::outputNames(program);
  const auto counts = [&](std::size_t i) { return program.outputs[i].pixel == program::OutputPixel::coverage; };
  if (request.allOutputs) {
    std::vector<std::size_t> selected;
    for (std::size_t i = 0; i < names.size(); ++i)
      if (!counts(i)) selected.push_back(i);
    return selected;
  }
  if (request.output.empty()) return {0};
  const auto found = std::ranges::find(names, request.output);
  if (found == names.end()) {
    std::vector<std::string> known = names;
    std::ranges::move(program::heatMapNames(), std::back_inserter(known));
    throw UsageError(fmt::format("output '{}' not found in the program '{}'{}; available: {}", request.output,
                                 program.name, suggestion(request.output, known), fmt::join(names, ", ")));
  }
  const auto index = static_cast<std::size_t>(found - names.begin());
  if (counts(index))
    throw UsageError(fmt::format("output '{}' counts ids and is not an image", request.output), Remedy::selectLayer);
  return {index};
}

}  // namespace

std::optional<FileKind> kindByExtension(const std::filesystem::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  if (extension == ".png") return FileKind::png;
  if (extension == ".exr") return FileKind::exr;
  if (extension == ".hdr") return FileKind::hdr;
  if (extension == render::kFilmExtension) return FileKind::film;
  return std::nullopt;
}

FileKind fileKind(const std::filesystem::path& file) {
  if (file == "-") return FileKind::png;
  if (const std::optional<FileKind> kind = kindByExtension(file)) return *kind;
  // Devices have no extension: /dev/null, /dev/stdout, a pipe.
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if (file.extension().empty() && std::filesystem::is_other(status)) return FileKind::png;
  if (std::filesystem::is_directory(status)) checkWritable(file);  // the clearer message
  throw UsageError(fmt::format("{}: the extension must be .png, .exr, .hdr or .qfilm", file.string()));
}

bool isStandardOutput(const std::filesystem::path& file) {
  return file == "-" || (!file.has_parent_path() && file.stem() == "-");
}

job::OutputNotes OutputPlan::notes() const {
  job::OutputNotes notes;
  notes.exposure = request.exposure.value_or(0.0);
  notes.toneMap = request.toneMap ? render::toneMapNames()[static_cast<std::size_t>(*request.toneMap)] : "";
  notes.allOutputs = request.allOutputs;
  notes.layers = layersText(layers);
  notes.names = std::ranges::find(layers, Layer::Source::coverage, &Layer::source) != layers.end();
  return notes;
}

program::Program withRequestedHeatMaps(program::Program program, const OutputRequest& request) {
  std::vector<std::string> names = request.layers;
  names.push_back(request.output);
  return program::withHeatMaps(std::move(program), names);
}

OutputPlan planOutputs(const OutputRequest& requested, const program::Program& program,
                       const job::FrameRequest& frames) {
  OutputPlan plan;
  OutputRequest& request = plan.request = requested;
  // The frames of an animation are images of their own. Those of a program that accumulates lead to one image.
  request.everyFrame = request.everyFrame || (program.accumulation == program::Accumulation::film &&
                                              frames.lastFrame() > frames.firstFrame());
  plan.kind = checkRequest(request);
  plan.outputs = selectOutputs(request, program);
  for (const std::size_t output : plan.outputs) plan.outputNames.push_back(program.outputs[output].name);
  plan.layers = selectLayers(availableLayers(program), request.layers, fmt::format("the program '{}'", program.name),
                             program::heatMapNames());
  checkChannels(plan.layers);
  std::vector<std::size_t> required = plan.outputs;
  for (const Layer& layer : plan.layers) required.push_back(layer.output);
  for (const std::size_t output : required) {
    const program::Output& description = program.outputs[output];
    if (description.optional && std::ranges::find(plan.optionalOutputs, description.name) == plan.optionalOutputs.end())
      plan.optionalOutputs.push_back(description.name);
  }
  checkFiles(plan, program::outputNames(program), frames);
  return plan;
}

void checkMergeRequest(const OutputRequest& request) {
  if (checkRequest(request) == FileKind::film && !request.layers.empty())
    throw UsageError("a film keeps all layers of its parts: layers can be selected for OpenEXR files only");
}

OutputPlan planOutputs(const OutputRequest& request, const job::RenderResult& merged,
                       const std::filesystem::path& film) {
  checkMergeRequest(request);
  const job::Provenance& p = merged.provenance;
  OutputPlan plan;
  plan.request = request;
  plan.kind = fileKind(request.file);
  plan.request.allOutputs = request.allOutputs || p.allOutputs;
  if (plan.request.allOutputs && isStandardOutput(request.file))
    throw UsageError("the parts were rendered with all outputs, but standard output takes one image");
  if (!plan.request.exposure) plan.request.exposure = p.exposure.value_or(0.0);
  if (!plan.request.toneMap) plan.request.toneMap = render::toneMapByName(p.toneMap);
  try {
    plan.layers = parseLayers(p.layers, *merged.film);
  } catch (const UsageError& error) {
    throw FileError(film, "header", error.what());
  }
  if (!request.layers.empty()) plan.layers = selectLayers(plan.layers, request.layers, "these films");
  const std::vector<render::FilmPlane>& planes = merged.film->planes();
  for (std::size_t i = 0; i < planes.size(); ++i)
    if ((i == 0 || plan.request.allOutputs) && merged.film->stores(i) &&
        planes[i].pixel != program::OutputPixel::coverage) {
      plan.outputs.push_back(i);
      plan.outputNames.push_back(planes[i].name);
    }
  std::vector<std::string> names;
  for (const render::FilmPlane& plane : planes) names.push_back(plane.name);
  checkFiles(plan, names, {});
  return plan;
}

void storeNotes(const OutputPlan& plan, job::RenderResult& result) {
  const job::OutputNotes notes = plan.notes();
  result.provenance.exposure = notes.exposure;
  result.provenance.toneMap = notes.toneMap;
  result.provenance.allOutputs = notes.allOutputs;
}

void checkSize(const OutputPlan& plan, uvec2 size) {
  if (plan.kind != FileKind::exr || size.x == 0 || size.y == 0) return;
  const ExrFormat format = plan.request.exr.value_or(ExrFormat());
  io::checkExrSize(size.x, size.y, channelCount(plan.layers, 4), format.options.tileSize);
}

std::string ignoredDisplayText(const OutputRequest& request) {
  const bool requested = request.toneMap || request.exposure.value_or(0.0) != 0.0;
  const FileKind kind = fileKind(request.file);
  if (!requested || kind == FileKind::png || kind == FileKind::film) return "";
  return fmt::format("{}: the file contains linear radiance, so exposure and tone map do not apply",
                     request.file.string());
}

}  // namespace quintet::output
