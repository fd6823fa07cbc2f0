// SPDX-License-Identifier: Apache-2.0
// Layers besides the image (AOVs): which a program offers, which were selected, and their channels in an OpenEXR file.
// docs/aov.md lists those of the path tracer.
#ifndef QUINTET_OUTPUT_LAYERS_H
#define QUINTET_OUTPUT_LAYERS_H

#include <cstddef>
#include <string>
#include <vector>

#include "io/exr/exr.h"
#include "job/result.h"
#include "program/description/program.h"

namespace quintet::output {

struct Layer {
  enum class Source { output, coverage, variance, sampleCount };

  std::string name;  // as selected; also in the file, except coverage (Cryptomatte has names of its own)
  std::string help;
  std::vector<std::string> channels;  // suffixes in the file: "R", "G", "B"
  bool exact = true;                  // data, stored losslessly as floats; false: a color
  Source source = Source::output;
  std::size_t output = 0;  // of the program, for Source::output and coverage
};

// All outputs of the program except the first, and what the film knows about the first.
std::vector<Layer> availableLayers(const program::Program& program);

// Returns those with these names, in the order of `available`; "all" selects every one. `owner` starts the error message:
// "the program 'ao'". Throws UsageError with the nearest name, of these and of `alsoSuggested`: what the owner has only on
// request.
std::vector<Layer> selectLayers(const std::vector<Layer>& available, const std::vector<std::string>& names,
                                const std::string& owner, const std::vector<std::string>& alsoSuggested = {});

// Throws UsageError if two layers would have a channel of the same name (`object` and `cryptomatte_object`), or if readers
// of Cryptomatte could not distinguish them (`object` and `object2`).
void checkChannels(const std::vector<Layer>& layers);

// One line for each layer: name, channels, help.
std::string layerList(const program::Program& program);

// Number of channels of a file with these layers and an image of `imageChannels` channels.
std::size_t channelCount(const std::vector<Layer>& layers, std::size_t imageChannels);

// The selected layers as text for films, and back. Throws UsageError for a text that does not fit the film.
std::string layersText(const std::vector<Layer>& layers);
std::vector<Layer> parseLayers(const std::string& text, const job::FilmView& film);

// Appends the channels of a layer. `colors`: channel type of colors.
void addLayer(io::ExrImage& image, const Layer& layer, const job::RenderResult& result, io::ExrType colors);

// Appends channels "layer.SUFFIX", or "SUFFIX" for an empty name, from the first channels of `pixels`.
void addChannels(io::ExrImage& image, const std::string& layer, const std::vector<std::string>& suffixes,
                 const io::Image& pixels, io::ExrType colors, bool exact);

}  // namespace quintet::output
#endif
