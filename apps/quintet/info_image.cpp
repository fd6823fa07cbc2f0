#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "info.h"
#include "io/codec.h"
#include "io/exr.h"
#include "render/film_file.h"
#include "values.h"

namespace quintet::app {
namespace {

const char* typeText(io::PixelType type) {
  switch (type) {
    case io::PixelType::u8: return "8 bits";
    case io::PixelType::u16: return "16 bits";
    case io::PixelType::f32: return "float";
  }
  return "";
}

}  // namespace

std::string imageInfo(const std::filesystem::path& file, std::span<const std::byte> bytes, bool json) {
  if (io::isOpenExr(bytes)) return exrInfo(file, bytes, json);  // its layers need not make a picture
  if (render::isFilmFile(bytes)) return filmInfo(file, bytes, json);
  const io::ImageInfo info = io::probeImage(bytes, file.string());
  const io::Metadata metadata = io::readMetadata(bytes, file.string());
  if (json) {
    using Json = nlohmann::ordered_json;
    Json texts = Json::object();
    for (const auto& [keyword, text] : metadata) texts[keyword] = text;
    const Json result{{"file", file.string()},       {"kind", "image"},       {"format", info.format},
                      {"width", info.width},         {"height", info.height}, {"channels", info.channels},
                      {"type", typeText(info.type)}, {"bytes", bytes.size()}, {"metadata", std::move(texts)}};
    return result.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  }
  std::string text = fmt::format("{}: {}, {}x{}, {} channels, {}, {}\n", plain(file.string()), info.format, info.width,
                                 info.height, info.channels, typeText(info.type), bytesText(bytes.size()));
  for (const auto& [keyword, value] : metadata) text += fmt::format("   {:<13}{}\n", plain(keyword), plain(value));
  return text;
}

}  // namespace quintet::app
