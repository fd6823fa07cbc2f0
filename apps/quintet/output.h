// The picture file that a command writes.
#ifndef QUINTET_APP_OUTPUT_H
#define QUINTET_APP_OUTPUT_H

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "io/codec.h"
#include "render/tone_map.h"

namespace quintet::app {

// film: render/film_file.h
enum class OutputKind { png, exr, hdr, film };

// By the extension, any case; "-" is PNG. Throws UsageError.
OutputKind outputKind(const std::filesystem::path& file);

// Fails before the work is done rather than after it: the kind is known, the file can be written.
void checkOutput(const std::filesystem::path& file);

struct DisplayOptions {
  render::ToneMap toneMap = render::ToneMap::linear;
  float exposure = 0;  // stops
  bool opaque = true;
};

// PNG or Radiance HDR. `image`: linear premultiplied RGBA. PNG is tone mapped, Radiance HDR gets the linear values.
void writePicture(const std::filesystem::path& file, const io::Image& image, const DisplayOptions& display,
                  const io::Metadata& metadata);

// That --exposure and --tonemap, if given, change nothing in such a file; empty: they do. A film remembers them for its
// picture.
std::string unshownText(const std::filesystem::path& file, bool given);

// Replaces `file` in one step, while no signal ends the process; "-" is the standard output.
void writeBytes(const std::filesystem::path& file, std::span<const std::byte> bytes);

}  // namespace quintet::app
#endif
