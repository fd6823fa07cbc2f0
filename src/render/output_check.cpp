#include "render/output_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "render/instrument.h"

namespace quintet::render {

void checkOutputs(const program::Program& description, const Film& film, std::vector<shader::Diagnostic>& result) {
  const std::string file = description.path(sourceFile(description, description.rayGeneration));
  for (std::size_t output = 0; output < description.outputs.size(); ++output) {
    if (!film.stores(output) || description.outputs[output].pixel == program::OutputPixel::coverage) continue;
    const io::Image image = film.download(output);
    const std::span<const float> values = image.samples<float>();
    const auto bad = std::ranges::find_if_not(values, [](float v) { return std::isfinite(v); });
    if (bad == values.end()) continue;
    const auto count = std::ranges::count_if(values, [](float v) { return !std::isfinite(v); });
    const auto pixel = static_cast<std::uint64_t>(bad - values.begin()) / 4;
    result.push_back(
        {shader::Severity::error, file, 0, 0, "Q002",
         fmt::format("output '{}' is {} at pixel {}, {}; {} values are not finite", description.outputs[output].name,
                     *bad, film.region().x + pixel % image.width, film.region().y + pixel / image.width, count)});
  }
  if (const std::uint64_t dropped = film.countRays().droppedSamples; dropped > 0)
    result.push_back({shader::Severity::error, file, 0, 0, "Q002",
                      fmt::format("{} samples were not finite; the program left them out", dropped)});
}

}  // namespace quintet::render
