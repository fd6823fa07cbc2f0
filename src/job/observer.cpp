// SPDX-License-Identifier: Apache-2.0
#include "job/observer.h"

#include <algorithm>
#include <limits>

#include "base/file.h"

namespace quintet::job {

double Progress::fraction() const {
  double done = 0;
  if (sampleLimit && *sampleLimit > 0) done = samples / static_cast<double>(*sampleLimit);
  if (targetSamples && *targetSamples > 0) done = std::max(done, samples / *targetSamples);
  if (secondLimit && *secondLimit > 0) done = std::max(done, seconds / *secondLimit);
  return std::clamp(done, 0.0, 1.0);
}

double Progress::secondsLeft() const {
  double left = std::numeric_limits<double>::infinity();
  if (secondLimit) left = std::max(*secondLimit - seconds, 0.0);
  const auto limitBy = [&](double limit) {
    if (samples > 0) left = std::min(left, std::max((limit / samples - 1.0) * seconds, 0.0));
  };
  if (sampleLimit) limitBy(static_cast<double>(*sampleLimit));
  if (targetSamples) limitBy(*targetSamples);
  return left;
}

void Observer::write(const std::filesystem::path& file, std::span<const std::byte> bytes) { writeFile(file, bytes); }

}  // namespace quintet::job
