// SPDX-License-Identifier: Apache-2.0
#include "shader/specialization.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <string_view>
#include <utility>

#include "quintet/shared/features.h"

namespace quintet::shader {
namespace {

constexpr std::string_view kTextureSlotsName = "QUINTET_TEXTURE_SLOTS";

// Definitions that remove a feature. Others, such as QUINTET_NO_SEEDS, change members and stages: they stay definitions.
constexpr std::array<std::pair<std::string_view, std::uint32_t>, 17> kFeatures{{
    {"QUINTET_NO_SOLID_TRANSMISSION", QUINTET_ID_SOLID_TRANSMISSION},
    {"QUINTET_NO_THIN_TRANSMISSION", QUINTET_ID_THIN_TRANSMISSION},
    {"QUINTET_NO_PANES", QUINTET_ID_PANES},
    {"QUINTET_NO_CLEARCOAT", QUINTET_ID_CLEARCOAT},
    {"QUINTET_NO_SHEEN", QUINTET_ID_SHEEN},
    {"QUINTET_NO_DIFFUSE_TRANSMISSION", QUINTET_ID_DIFFUSE_TRANSMISSION},
    {"QUINTET_NO_ANISOTROPY", QUINTET_ID_ANISOTROPY},
    {"QUINTET_NO_IRIDESCENCE", QUINTET_ID_IRIDESCENCE},
    {"QUINTET_NO_DISPERSION", QUINTET_ID_DISPERSION},
    {"QUINTET_NO_SCATTERING", QUINTET_ID_SCATTERING},
    {"QUINTET_NO_NESTED_MEDIA", QUINTET_ID_NESTED_MEDIA},
    {"QUINTET_NO_TRIANGLE_LIGHTS", QUINTET_ID_TRIANGLE_LIGHTS},
    {"QUINTET_NO_SOLID_LIGHTS", QUINTET_ID_SOLID_LIGHTS},
    {"QUINTET_NO_PUNCTUAL_LIGHTS", QUINTET_ID_PUNCTUAL_LIGHTS},
    {"QUINTET_NO_ENVIRONMENT", QUINTET_ID_ENVIRONMENT},
    {"QUINTET_NO_LIGHT_TREE", QUINTET_ID_LIGHT_TREE},
    {"QUINTET_NO_VERTEX_COLORS", QUINTET_ID_VERTEX_COLORS},
}};

// Reads the literal that the renderer writes: "0x1fu".
std::optional<std::uint32_t> readBits(std::string_view text) {
  std::uint32_t bits = 0;
  if (!text.starts_with("0x") || !text.ends_with('u')) return {};
  const char* end = text.data() + text.size() - 1;
  const auto [last, error] = std::from_chars(text.data() + 2, end, bits, 16);
  if (error != std::errc() || last != end) return {};
  return bits;
}

}  // namespace

std::optional<GenericSource> makeGeneric(const Source& source) {
  GenericSource generic{source, {{QUINTET_ID_TEXTURE_SLOTS, 0xFFFFFFFFu}}};
  for (const auto& [name, id] : kFeatures) generic.values[id] = 1;
  generic.source.defines = {{"QUINTET_SPECIALIZE", "1"}};
  for (const auto& [name, value] : source.defines) {
    const auto feature = std::ranges::find(kFeatures, name, &std::pair<std::string_view, std::uint32_t>::first);
    if (feature != kFeatures.end()) {
      if (value != "1") return {};
      generic.values[feature->second] = 0;
    } else if (name == kTextureSlotsName) {
      const std::optional<std::uint32_t> bits = readBits(value);
      if (!bits) return {};
      generic.values[QUINTET_ID_TEXTURE_SLOTS] = *bits;
    } else {
      generic.source.defines.emplace_back(name, value);
    }
  }
  return generic;
}

std::string shippedName(const Hash& key) { return key.hex() + ".spv"; }

std::vector<std::uint32_t> findShipped(std::span<const EmbeddedFile> shipped, const Hash& key) {
  const std::string name = shippedName(key);
  const auto found = std::ranges::lower_bound(shipped, std::string_view(name), {}, &EmbeddedFile::path);
  if (found == shipped.end() || found->path != name) return {};
  std::vector<std::uint32_t> words(found->data.size() / sizeof(std::uint32_t));
  std::memcpy(words.data(), found->data.data(), words.size() * sizeof(std::uint32_t));
  return words;
}

}  // namespace quintet::shader
