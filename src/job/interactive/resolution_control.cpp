// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/resolution_control.h"

#include <array>

namespace quintet::job::interactive {
namespace {

constexpr std::array kFactors{1u, 2u, 3u, 4u, 6u, 8u, 12u, 16u};
// A finer resolution must fit into this share of the time, so that the factor does not alternate.
constexpr double kFinerShare = 0.7;

}  // namespace

void ResolutionControl::measured(unsigned factor, double seconds) {
  const double fullSeconds = seconds * factor * factor;
  const auto fits = [&](unsigned f) { return fullSeconds / (f * f) <= (f < factor_ ? kFinerShare : 1.0) * target_; };
  std::size_t chosen = 0;
  while (chosen + 1 < kFactors.size() && !fits(kFactors[chosen])) ++chosen;
  factor_ = kFactors[chosen];
}

unsigned finerFactor(unsigned factor) { return factor / 2; }

uvec2 reducedSize(uvec2 size, unsigned factor) { return (size + uvec2(factor - 1)) / uvec2(factor); }

}  // namespace quintet::job::interactive
