// SPDX-License-Identifier: Apache-2.0
// Which files a render writes, and what they show. The plan is made before the render, so that a wrong name or option fails
// at once.
#ifndef QUINTET_OUTPUT_PLAN_H
#define QUINTET_OUTPUT_PLAN_H

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/exr/exr.h"
#include "job/request.h"
#include "job/result.h"
#include "output/layers.h"
#include "program/description/program.h"
#include "render/tone_map/tone_map.h"

namespace quintet::output {

enum class FileKind { png, exr, hdr, film };

// By the extension, in any case; unset for other extensions and without one.
std::optional<FileKind> kindByExtension(const std::filesystem::path& file);
// The same; "-" and devices without extension are PNG. Throws UsageError.
FileKind fileKind(const std::filesystem::path& file);

// "-" means PNG on standard output; "-.png", "-.exr" and "-.hdr" name the format.
bool isStandardOutput(const std::filesystem::path& file);

struct ExrFormat {
  io::ExrType colors = io::ExrType::half;  // data are always floats
  io::ExrOptions options;
};

// Largest absolute value of OutputRequest::exposure; factors of 2^±100 are far outside of what images hold.
inline constexpr double kMaxExposure = 100;

struct OutputRequest {
  std::filesystem::path file;  // or standard output: isStandardOutput()
  std::string output;          // of the program; empty means the first
  bool allOutputs = false;     // one file for each output
  // An image of each frame, with its number in the name (file_names.h). In a plan, also for several frames of an animation.
  bool everyFrame = false;
  std::vector<std::string> layers;         // names of layers besides the image, or "all"
  std::optional<double> exposure;          // stops; PNG only. Default: 0, or as stored in a film
  std::optional<render::ToneMap> toneMap;  // PNG only. Default: by the kind of output, or as stored in a film
  std::optional<unsigned> pngBits;         // 8 or 16 per channel; PNG only. Default: 8
  std::optional<ExrFormat> exr;            // only for OpenEXR files
};

struct OutputPlan {
  OutputRequest request;
  FileKind kind = FileKind::png;
  std::vector<std::size_t> outputs;      // of the program, those that get a file
  std::vector<std::string> outputNames;  // parallel to `outputs`
  std::vector<Layer> layers;

  // Names of the program's optional outputs that the files require: job::RenderRequest::outputs.
  std::vector<std::string> optionalOutputs;
  // What a film of the render must remember: job::RenderRequest::outputNotes.
  job::OutputNotes notes() const;
};

// Returns the program with the heat maps that the request names (program/heat.h). Plans and jobs use the result.
program::Program withRequestedHeatMaps(program::Program program, const OutputRequest& request);

// For a program. Throws UsageError for unknown names and for options that exclude each other, FileError if one of the files
// cannot be written: of each output and, with `everyFrame`, of each frame.
OutputPlan planOutputs(const OutputRequest& request, const program::Program& program,
                       const job::FrameRequest& frames = {});

// For a merged film. What the request leaves open is as the render would have written it. `film`: name of the first part, for
// messages. Throws also FileError if the layers that the film stores are invalid.
OutputPlan planOutputs(const OutputRequest& request, const job::RenderResult& merged,
                       const std::filesystem::path& film);

// The part of planOutputs() for a merged film that needs no film. Throws UsageError, FileError.
void checkMergeRequest(const OutputRequest& request);

// Puts the plan's display settings into the result's provenance, for the film that is written of it.
void storeNotes(const OutputPlan& plan, job::RenderResult& result);

// Throws UsageError if an image of this size does not fit the file format. A size that contains 0 is not known yet.
void checkSize(const OutputPlan& plan, uvec2 size);

// That exposure and tone map, if requested, do not apply to the file: a note for the user; empty if they do.
std::string ignoredDisplayText(const OutputRequest& request);

}  // namespace quintet::output
#endif
