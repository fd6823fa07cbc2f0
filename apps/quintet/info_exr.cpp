// `quintet info` of an OpenEXR file: its parts, layers, channels, windows and attributes.
#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "info.h"
#include "io/exr.h"
#include "values.h"

namespace quintet::app {
namespace {

using Json = nlohmann::ordered_json;
using Part = io::ExrPartInfo;

constexpr std::size_t kMaxText = 240;  // characters of an attribute, for people: a manifest may have thousands

const char* typeText(io::ExrType type) {
  return type == io::ExrType::half ? "half" : type == io::ExrType::f32 ? "float" : "uint";
}

// Channels of one layer and one type: a layer of several types has several rows.
struct Layer {
  std::string name;
  io::ExrType type;
  std::vector<std::string> channels;  // without the layer's name
};

// The order that people expect: R before G and B, A last.
std::size_t rankOf(const std::string& channel) {
  constexpr std::string_view kOrder = "RGBXYZWUVuvA";
  const std::size_t at = channel.size() == 1 ? kOrder.find(channel[0]) : kOrder.npos;
  return std::min(at, kOrder.size());
}

std::vector<Layer> layersOf(const Part& part) {
  std::vector<Layer> layers;
  for (const Part::Channel& channel : part.channels) {
    const std::string name(io::exrLayerOf(channel.name));
    auto at = std::ranges::find_if(layers, [&](const Layer& l) { return l.name == name && l.type == channel.type; });
    if (at == layers.end()) at = layers.insert(layers.end(), Layer{name, channel.type, {}});
    at->channels.push_back(channel.name.substr(name.empty() ? 0 : name.size() + 1));
  }
  for (Layer& layer : layers) std::ranges::stable_sort(layer.channels, {}, rankOf);
  std::ranges::stable_sort(layers, [](const Layer& a, const Layer& b) { return a.name.empty() && !b.name.empty(); });
  return layers;
}

bool isWhole(const Part& part) {
  return part.data.x == part.display.x && part.data.y == part.display.y && part.data.width == part.display.width &&
         part.data.height == part.display.height;
}

Json windowJson(const Part::Window& window) { return {window.x, window.y, window.width, window.height}; }

Json partJson(const Part& part) {
  Json layers = Json::array();
  for (const Layer& layer : layersOf(part))
    layers.push_back({{"name", layer.name}, {"type", typeText(layer.type)}, {"channels", layer.channels}});
  Json attributes = Json::object();
  for (const Part::Attribute& attribute : part.attributes)
    attributes[attribute.name] = {{"type", attribute.type}, {"value", attribute.text}};
  Json json{{"name", part.name},
            {"compression", part.compression},
            {"tiles", part.tileWidth > 0 ? Json{part.tileWidth, part.tileHeight} : Json()},
            {"deep", part.deep},
            {"dataWindow", windowJson(part.data)},
            {"displayWindow", windowJson(part.display)},
            {"layers", std::move(layers)},
            {"attributes", std::move(attributes)}};
  return json;
}

std::string json(const std::filesystem::path& file, std::size_t bytes, const std::vector<Part>& parts) {
  std::size_t channels = 0;
  Json texts = Json::object(), all = Json::array();
  for (const Part& part : parts) {
    channels += part.channels.size();
    all.push_back(partJson(part));
  }
  for (const Part::Attribute& attribute : parts.front().attributes)
    if (attribute.type == "string") texts[attribute.name] = attribute.text;
  const Json result{{"file", file.string()},
                    {"kind", "image"},
                    {"format", "OpenEXR"},
                    {"width", parts.front().display.width},
                    {"height", parts.front().display.height},
                    {"channels", channels},
                    {"type", "float"},
                    {"bytes", bytes},
                    {"metadata", std::move(texts)},
                    {"parts", std::move(all)}};
  return result.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string partText(const Part& part, bool several) {
  std::string text;
  if (several)
    text += fmt::format("   part {:<8}{}{}\n", plain(part.name), part.compression, part.deep ? ", deep" : "");
  if (!isWhole(part))
    text += fmt::format("   data window  {}x{} at {}, {}\n", part.data.width, part.data.height,
                        part.data.x - part.display.x, part.data.y - part.display.y);
  for (const Layer& layer : layersOf(part))
    text += fmt::format("   {:<24} {:<6} {}\n", layer.name.empty() ? "(beauty)" : plain(layer.name),
                        typeText(layer.type), plain(fmt::format("{}", fmt::join(layer.channels, " "))));
  return text;
}

std::string attributesText(const Part& part) {
  std::string text;
  for (const Part::Attribute& attribute : part.attributes) {
    std::string value = plain(attribute.text);
    if (value.size() > kMaxText) value = value.substr(0, kMaxText) + "...";
    if (attribute.text.empty() && attribute.type != "string") value = "(" + attribute.type + ")";
    text += fmt::format("   {:<13}{}{}\n", plain(attribute.name), attribute.name.size() >= 13 ? " " : "", value);
  }
  return text;
}

}  // namespace

std::string exrInfo(const std::filesystem::path& file, std::span<const std::byte> bytes, bool wantsJson) {
  const std::vector<Part> parts = io::inspectExr(bytes, file.string());
  if (wantsJson) return json(file, bytes.size(), parts);
  const Part& first = parts.front();
  std::size_t channels = 0;
  for (const Part& part : parts) channels += part.channels.size();
  const std::string how =
      first.tileWidth > 0 ? fmt::format("tiles of {}x{}", first.tileWidth, first.tileHeight) : "scan lines";
  std::string text =
      fmt::format("{}: OpenEXR, {}x{}, {} channels, {}, {}, {}\n", plain(file.string()), first.display.width,
                  first.display.height, channels, first.compression, how, bytesText(bytes.size()));
  for (const Part& part : parts) text += partText(part, parts.size() > 1);
  return text + attributesText(first);
}

}  // namespace quintet::app
