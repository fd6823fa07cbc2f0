#include "aov_cryptomatte.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/parallel.h"
#include "io/cryptomatte.h"

namespace quintet::app {
namespace {

using shared::CoverageSlot;
using shared::kCoverageId;
using shared::kCoverageSlots;

constexpr std::size_t kRanks = 2 * kCryptomatteLayers;
constexpr std::string_view kPrefix = "cryptomatte_";
constexpr std::size_t kWholeManifest = 65536;  // names; of more, only those that the picture shows

struct Thing {
  std::string name;
  float id = 0;
};

// What is counted, by the number that the program stored.
class Things {
 public:
  Things(const std::string& output, const CoverageNames& names, std::span<const CoverageSlot> slots)
      : output_(output), names_(chooseNames(output, names)) {
    for (const CoverageSlot& slot : slots)
      if (slot.samples > 0 && !seen_.contains(slot.id)) seen_.emplace(slot.id, makeThing(slot.id));
  }

  float id(std::uint32_t number) const { return seen_.at(number).id; }

  // All names of the scene, in its order, where these are not too many; and those that are seen.
  std::vector<std::string> manifest() const {
    std::vector<std::string> names;
    if (names_ && names_->size() <= kWholeManifest) names = *names_;
    if (names.empty())
      for (const auto& [number, thing] : seen_) names.push_back(thing.name);
    return names;
  }

 private:
  static const std::vector<std::string>* chooseNames(const std::string& output, const CoverageNames& names) {
    if (output == "cryptomatte_object") return &names.instances;
    if (output == "cryptomatte_material") return &names.materials;
    return nullptr;
  }

  Thing makeThing(std::uint32_t number) const {
    const std::uint32_t index = number >= kCoverageId ? number - kCoverageId : number;
    std::string name = names_ && index < names_->size() ? (*names_)[index] : fmt::format("{}#{}", output_, index);
    const float id = io::cryptomatteId(name);
    return {std::move(name), id};
  }

  const std::string& output_;
  const std::vector<std::string>* names_;
  std::map<std::uint32_t, Thing> seen_;
};

}  // namespace

std::string cryptomatteType(const std::string& output) {
  std::string type = "Crypto";
  bool begins = true;
  for (const char c : output.starts_with(kPrefix) ? output.substr(kPrefix.size()) : output) {
    if (c != '_') type += begins ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    begins = c == '_';
  }
  return type;
}

void addCryptomatte(io::ExrPicture& picture, const AovLayer& layer, const AovSource& source,
                    const CoverageNames& names) {
  const render::FilmPlane plane = source.plane(layer.output);
  const Things things(layer.name, names, plane.coverage);
  const std::string type = cryptomatteType(layer.name);
  std::vector<io::ExrChannel> channels(2 * kRanks);
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  for (std::size_t i = 0; i < channels.size(); ++i)
    channels[i] = {io::cryptomatteChannel(type, i / 2, i % 2 == 1), io::ExrType::f32, std::vector<float>(pixels), true};

  render::FilmState cells;
  cells.region = source.region;
  parallelFor(picture.height, [&](std::size_t y) {
    std::vector<io::CryptomatteCoverage> found;
    for (std::uint32_t x = 0; x < picture.width; ++x) {
      const std::size_t pixel = y * picture.width + x;
      const auto samples = static_cast<float>(source.counts.samplesOf(cells.cellOf(x, static_cast<std::uint32_t>(y))));
      found.clear();
      for (const CoverageSlot& slot : std::span(plane.coverage).subspan(pixel * kCoverageSlots, kCoverageSlots))
        if (slot.samples > 0) found.push_back({things.id(slot.id), static_cast<float>(slot.samples) / samples});
      const std::vector<io::CryptomatteCoverage> ranks = io::rankCryptomatte(found, kRanks);
      for (std::size_t rank = 0; rank < kRanks; ++rank) {
        channels[2 * rank].samples[pixel] = ranks[rank].id;
        channels[2 * rank + 1].samples[pixel] = ranks[rank].coverage;
      }
    }
  });
  std::ranges::move(channels, std::back_inserter(picture.channels));
  for (auto& entry : io::cryptomatteMetadata(type, things.manifest())) picture.metadata.push_back(std::move(entry));
}

}  // namespace quintet::app
