#include "output.h"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <string>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "render/film_file.h"
#include "signals.h"

namespace quintet::app {

OutputKind outputKind(const std::filesystem::path& file) {
  if (file == "-") return OutputKind::png;
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".png") return OutputKind::png;
  if (extension == ".exr") return OutputKind::exr;
  if (extension == ".hdr") return OutputKind::hdr;
  if (extension == render::kFilmExtension) return OutputKind::film;
  // Devices have no extension: /dev/null, /dev/stdout, a pipe.
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if (extension.empty() && std::filesystem::is_other(status)) return OutputKind::png;
  if (std::filesystem::is_directory(status)) checkWritable(file);  // the clearer message
  throw UsageError(fmt::format("{}: the extension must be .png, .exr, .hdr or .qfilm", file.string()));
}

void checkOutput(const std::filesystem::path& file) {
  outputKind(file);
  checkWritable(file);
}

void writePicture(const std::filesystem::path& file, const io::Image& image, const DisplayOptions& display,
                  const io::Metadata& metadata) {
  const OutputKind kind = outputKind(file);
  assert(kind == OutputKind::png || kind == OutputKind::hdr);
  if (kind == OutputKind::png)
    writeBytes(file,
               io::encodePng(render::toDisplay(image, display.toneMap, display.exposure, display.opaque), metadata));
  else
    writeBytes(file, io::encodeHdr(image));
}

std::string unshownText(const std::filesystem::path& file, bool given) {
  const OutputKind kind = outputKind(file);
  if (!given || kind == OutputKind::png || kind == OutputKind::film) return "";
  return fmt::format("{}: linear radiance, --exposure and --tonemap do not apply", file.string());
}

void writeBytes(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  if (file == "-") {
    writeFile(file, bytes);  // no temporary file: nothing to protect
  } else {
    const ProtectedWrite protect;
    writeFile(file, bytes);
  }
}

}  // namespace quintet::app
