// SPDX-License-Identifier: Apache-2.0
#include "output/cryptomatte_layer.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/parallel.h"
#include "io/exr/cryptomatte.h"

namespace quintet::output {
namespace {

using shared::CoverageSlot;
using shared::kCoverageId;
using shared::kCoverageSlots;

constexpr std::size_t kRanks = 2 * kCryptomatteLayers;
constexpr std::string_view kPrefix = "cryptomatte_";
// Number of names up to which the manifest lists the whole scene; of more, only what the image shows.
constexpr std::size_t kMaxWholeManifest = 65536;

struct Entry {
  std::string name;
  float id = 0;
};

// The counted things by the number that the program stored.
class Entries {
 public:
  Entries(const std::string& output, const job::Provenance& provenance, std::span<const CoverageSlot> slots)
      : output_(output) {
    if (output == "cryptomatte_object") names_ = &provenance.instanceNames;
    if (output == "cryptomatte_material") names_ = &provenance.materialNames;
    for (const CoverageSlot& slot : slots)
      if (slot.samples > 0 && !visible_.contains(slot.id)) visible_.emplace(slot.id, makeEntry(slot.id));
  }

  float id(std::uint32_t number) const { return visible_.at(number).id; }

  std::vector<std::string> manifest() const {
    std::vector<std::string> names;
    if (names_ && names_->size() <= kMaxWholeManifest) names = *names_;
    if (names.empty())
      for (const auto& [number, entry] : visible_) names.push_back(entry.name);
    return names;
  }

 private:
  Entry makeEntry(std::uint32_t number) const {
    const std::uint32_t index = number >= kCoverageId ? number - kCoverageId : number;
    std::string name = names_ && index < names_->size() ? (*names_)[index] : fmt::format("{}#{}", output_, index);
    const float id = io::cryptomatteId(name);
    return {std::move(name), id};
  }

  const std::string& output_;
  const std::vector<std::string>* names_ = nullptr;
  std::map<std::uint32_t, Entry> visible_;
};

}  // namespace

std::string cryptomatteType(const std::string& output) {
  std::string type = "Crypto";
  bool startsWord = true;
  for (const char c : output.starts_with(kPrefix) ? output.substr(kPrefix.size()) : output) {
    if (c != '_') type += startsWord ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    startsWord = c == '_';
  }
  return type;
}

std::vector<std::string> cryptomatteChannels(const std::string& output) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < 2 * kRanks; ++i)
    names.push_back(io::cryptomatteChannel(cryptomatteType(output), i / 2, i % 2 == 1));
  return names;
}

void addCryptomatte(io::ExrImage& image, const std::string& output, std::size_t index,
                    const job::RenderResult& result) {
  const render::FilmPlane plane = result.film->plane(index);
  const render::SampleCounts counts = result.film->counts();
  const Entries entries(output, result.provenance, plane.coverage);
  const std::size_t pixels = std::size_t{image.width} * image.height;
  std::vector<io::ExrChannel> channels;
  for (std::string& name : cryptomatteChannels(output))
    channels.push_back({std::move(name), io::ExrType::f32, std::vector<float>(pixels), true});

  render::FilmState cells;
  cells.region = result.provenance.region;
  parallelFor(image.height, [&](std::size_t y) {
    std::vector<io::CryptomatteCoverage> found;
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::size_t pixel = y * image.width + x;
      const auto samples = static_cast<float>(counts.samplesOf(cells.cellOf(x, static_cast<std::uint32_t>(y))));
      found.clear();
      for (const CoverageSlot& slot : std::span(plane.coverage).subspan(pixel * kCoverageSlots, kCoverageSlots))
        if (slot.samples > 0) found.push_back({entries.id(slot.id), static_cast<float>(slot.samples) / samples});
      const std::vector<io::CryptomatteCoverage> ranks = io::rankCryptomatte(found, kRanks);
      for (std::size_t rank = 0; rank < kRanks; ++rank) {
        channels[2 * rank].samples[pixel] = ranks[rank].id;
        channels[2 * rank + 1].samples[pixel] = ranks[rank].coverage;
      }
    }
  });
  std::ranges::move(channels, std::back_inserter(image.channels));
  for (auto& entry : io::cryptomatteMetadata(cryptomatteType(output), entries.manifest()))
    image.metadata.push_back(std::move(entry));
}

}  // namespace quintet::output
