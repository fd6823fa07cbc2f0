// Layers besides the picture (--aov): what a program offers, which were chosen, and how they get into an OpenEXR file.
// docs/aov.md has the table of the path tracer's.
#ifndef QUINTET_APP_AOV_H
#define QUINTET_APP_AOV_H

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "io/exr.h"
#include "program/program.h"
#include "render/renderer.h"

namespace quintet::app {

struct AovLayer {
  enum class Source { output, coverage, variance, sampleCount };

  std::string name;  // on the command line; in the file, too, but of coverage
  std::string help;
  std::vector<std::string> channels;
  bool exact = true;  // data; false: colours
  Source source = Source::output;
  std::size_t output = 0;  // of the program
};

// All outputs of the program but the first, and what the film knows of the first.
std::vector<AovLayer> aovLayers(const program::Program& program);
// "all" or names. Throws UsageError with the nearest name.
std::vector<AovLayer> chooseAovs(const program::Program& program, const std::vector<std::string>& names);
// The same among these layers; `none` begins the error: "the program 'ao' has".
std::vector<AovLayer> chooseAovs(const std::vector<AovLayer>& layers, const std::vector<std::string>& names,
                                 const std::string& none);
// Throws UsageError where two of them would have channels of the same name in a file (`object` and `cryptomatte_object`)
// or where readers of Cryptomatte could not tell two of them apart (`object` and `object2`).
void checkChannels(const std::vector<AovLayer>& layers);
// One line each, for --aov list.
std::string aovList(const program::Program& program);

// Names of what coverage counts, by index (scene/names.h).
struct CoverageNames {
  std::vector<std::string> instances;
  std::vector<std::string> materials;
};

// Channels that a file with these layers has; `first`: those of the picture.
std::size_t channelCount(const std::vector<AovLayer>& layers, std::size_t first);

// What layers are made from: a film on the device, or one from a file.
struct AovSource {
  render::Region region;
  render::SampleCounts counts;
  std::function<io::Image(std::size_t output)> image;
  std::function<render::FilmPlane(std::size_t output)> plane;  // of coverage
  std::function<io::Image()> variance;
};
AovSource aovSource(const render::Renderer& renderer);
AovSource aovSource(const render::FilmState& film);  // outlives the source

void addAov(io::ExrPicture& picture, const AovLayer& layer, const AovSource& source, const CoverageNames& names,
            io::ExrType colors);

}  // namespace quintet::app
#endif
