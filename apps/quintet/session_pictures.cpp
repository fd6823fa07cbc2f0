// The session's pictures: which outputs of the program they show, their files, and the report at the end.
#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/file.h"
#include "exr_camera.h"
#include "exr_output.h"
#include "picture_names.h"
#include "program_setup.h"
#include "session.h"
#include "standard_error.h"
#include "values.h"

namespace quintet::app {

std::vector<std::size_t> Session::chosenOutputs() const {
  const std::vector<std::string> names = program::outputNames(program_);
  std::vector<std::size_t> chosen;
  if (options_.allOutputs) {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (program_.outputs[i].pixel != program::OutputPixel::coverage) chosen.push_back(i);
  } else if (options_.outputName.empty()) {
    chosen.push_back(0);
  } else {
    const auto found = std::ranges::find(names, options_.outputName);
    if (found == names.end())
      throw UsageError(fmt::format("--output: the program '{}' has no output '{}'{}; there are {} (-o names the file)",
                                   program_.name, options_.outputName, suggestion(options_.outputName, names),
                                   fmt::join(names, ", ")));
    chosen.push_back(static_cast<std::size_t>(found - names.begin()));
    if (program_.outputs[chosen.back()].pixel == program::OutputPixel::coverage)
      throw UsageError(fmt::format("--output: '{}' counts ids and is no picture: use --aov {}", options_.outputName,
                                   options_.outputName));
  }
  return chosen;
}

std::vector<std::string> Session::wantedOutputs() const {
  std::vector<std::size_t> wanted = chosenOutputs();
  for (const AovLayer& layer : aovs_) wanted.push_back(layer.output);
  std::vector<std::string> names;
  for (const std::size_t output : wanted)
    if (program_.outputs[output].optional) names.push_back(program_.outputs[output].name);
  return names;
}

void Session::write(const RenderOutcome& outcome, std::optional<std::uint32_t> frame) {
  if (outputKind(options_.output) == OutputKind::film) return writeFilm(outcome);
  progress_.stage("writing " + options_.output.string());
  fillRecord(outcome);
  record_.frame = frame ? frame : outcome.frame;
  record_.files.clear();
  for (const std::size_t output : chosenOutputs()) {
    const std::string& name = program_.outputs[output].name;
    const std::filesystem::path file = pictureName(options_.output, options_.allOutputs ? name : "", frame);
    const DisplayOptions display{chooseToneMap(program_.outputs[output], options_), options_.exposure,
                                 !options_.transparent};
    const bool toned = outputKind(file) == OutputKind::png;
    record_.toneMap = toned ? render::toneMapNames()[static_cast<std::size_t>(display.toneMap)] : "";
    record_.outputName = name;
    record_.files.push_back(file.string());
    if (outputKind(file) == OutputKind::exr)
      writeBytes(file, exrFile(output));
    else
      writePicture(file, renderer_->image(output), display, metadata(record_));
  }
  record_.totalSeconds = clock_.seconds();
}

std::vector<std::byte> Session::exrFile(std::size_t output) const {
  io::ExrPicture picture =
      exrPicture(renderer_->film().region(), sceneInfo_.size.x, sceneInfo_.size.y, metadata(record_));
  addCamera(picture, shownCamera(program_, sceneInfo_.camera, sceneInfo_.size));
  const bool exact = !program::holdsColor(program_.outputs[output]);
  addBeauty(picture, renderer_->image(output), options_.transparent, options_.exr.colors, exact);
  const AovSource source = aovSource(*renderer_);
  for (const AovLayer& layer : aovs_) addAov(picture, layer, source, sceneInfo_.names, options_.exr.colors);
  return io::encodeExr(picture, options_.exr.options);
}

void Session::report() {
  if (record_.wantedError && !record_.interrupted && !record_.error.reaches(*record_.wantedError))
    warnings_.add(unreachedText(record_));
  if (record_.droppedSamples > 0)
    warnings_.add(fmt::format("{} samples were not finite and left out", record_.droppedSamples));
  record_.warnings = warnings_.take();
  progress_.clear();
  for (const std::string& warning : record_.warnings) printError("quintet: warning: {}\n", warning);
  if (options_.json) writeFile("-", toJson(record_));
  progress_.note(summary(record_));
}

}  // namespace quintet::app
