// What a film file says about its rendering (render/film_file.h): the facts that films must share to belong together,
// and notes from which a picture's metadata is made again.
#ifndef QUINTET_APP_FILM_FACTS_H
#define QUINTET_APP_FILM_FACTS_H

#include <optional>
#include <string>
#include <vector>

#include "metadata.h"
#include "program/program.h"
#include "render/film_file.h"
#include "render_options.h"
#include "scene/scene.h"

namespace quintet::app {

// Notes on how the picture is shown.
inline constexpr const char* kExposureFact = "exposure";  // stops
inline constexpr const char* kToneMapFact = "tone map";   // empty: by the kind of the output
inline constexpr const char* kAllOutputsFact = "all outputs";

// Of a linked rendering.
struct FilmSource {
  const program::Program& program;
  const program::ParameterValues& parameters;
  const std::vector<Hash>& shaderHashes;  // render::Renderer::shaderHashes
  std::string sceneHash;
  std::string environmentHash;
  const scene::Camera& camera;
  uvec2 size{0};  // of the whole image
  const render::Film& film;
};

// Equal for renderings that give the same samples. Reads the files that are named. Throws FileError.
render::FilmFacts filmIdentity(const FilmSource& source, const RenderOptions& options);

// Everything else. `record` is filled.
render::FilmFacts filmNotes(const program::Program& program, const RenderOptions& options, const RenderRecord& record);

std::string exposureText(float stops);
std::string toneMapText(const std::optional<render::ToneMap>& toneMap);

// Empty where there is none.
std::string factText(const render::FilmFacts& facts, const std::string& name);

// In place of what there is by this name.
void setFact(render::FilmFacts& facts, const std::string& name, const std::string& value);

// Fills in what filmNotes and filmIdentity told, and what the film counts.
void fillRecord(RenderRecord& record, const render::FilmFile& file);

// Samples per pixel that the rendering is to have in the end; nothing: as many as time allows.
std::optional<std::uint64_t> plannedSamples(const render::FilmFile& file);

// The error that was to be reached (--until-error); nothing: none.
std::optional<double> wantedErrorOf(const render::FilmFile& file);

bool isAdaptive(const render::FilmFile& file);

// "seed: 3 in the checkpoint, 4 here", one line for each difference; `left` is "in the checkpoint", `right` "here".
std::vector<std::string> differenceLines(const std::vector<render::FactDifference>& differences,
                                         const std::string& left, const std::string& right);

// "0 to 15", "0 to 15 and 32 to 63"; "none"
std::string rangesText(const std::vector<render::SampleRange>& ranges);
// "samples 0 to 15"; of an adaptive film "20.5 samples per pixel on average (16 to 24)"
std::string samplesText(const render::FilmFile& file);

}  // namespace quintet::app
#endif
