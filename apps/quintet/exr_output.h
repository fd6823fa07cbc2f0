// How OpenEXR files are written: the values of --exr-type, --exr-compression and --exr-tiles, and a file of layers.
#ifndef QUINTET_APP_EXR_OUTPUT_H
#define QUINTET_APP_EXR_OUTPUT_H

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/exr.h"
#include "render/film.h"

namespace quintet::app {

struct ExrFormat {
  io::ExrType colors = io::ExrType::half;  // data are floats always
  io::ExrOptions options;
};

// "half" or "float"; "dwaa" or "dwaa:45"; "64". Throw UsageError with the option's name.
io::ExrType parseExrType(const std::string& text);
void parseExrCompression(const std::string& text, io::ExrOptions& options);
std::uint32_t parseExrTiles(const std::string& text);

// Adds the first channels of `image` as channels "layer.SUFFIX", or "SUFFIX" for an empty name.
// Data (exact) are stored as floats, whatever `colors` says, and never lossily.
void addLayer(io::ExrPicture& picture, const std::string& layer, std::span<const std::string> suffixes,
              const io::Image& image, io::ExrType colors, bool exact);

// R, G, B and, if wanted, A.
void addBeauty(io::ExrPicture& picture, const io::Image& image, bool alpha, io::ExrType colors, bool exact);

// The picture's frame: a region stands where it is in the whole picture.
io::ExrPicture exrPicture(const render::Region& region, std::uint32_t width, std::uint32_t height,
                          io::Metadata metadata);

}  // namespace quintet::app
#endif
