// SPDX-License-Identifier: Apache-2.0
#include "render/lights/alias_table.h"

#include <limits>
#include <utility>

namespace quintet::render {
namespace {

// Pairs the entries as in M. Vose, "A Linear Algorithm for Generating Random Numbers with a Given Distribution" (1991),
// in the order of L. Hübschle-Schneider & P. Sanders, "Parallel Weighted Random Sampling" (2022), section 4.1: one
// cursor visits the light entries (scaled weight ≤ 1) and one the heavy entries, each in a single pass over memory
// without work lists. The current heavy entry fills up light entries. When its rest is at most 1, it becomes a light
// entry, which the next heavy entry fills up.
class Sweep {
 public:
  Sweep(std::span<const float> weights, double total)
      : weights_(weights), scale_(static_cast<double>(weights.size()) / total), table_(weights.size()) {}

  std::vector<shared::AliasEntry> run() {
    const std::size_t n = table_.size();
    std::size_t light = next(0, false);
    std::size_t heavy = next(0, true);
    const std::size_t fallback = heavy < n ? heavy : 0;
    double rest = heavy < n ? scaled(heavy) : 0.0;
    while (heavy < n && (rest <= 1.0 || light < n)) {
      if (rest > 1.0) {
        const double weight = scaled(light);
        gain_ += set(light, weight, heavy);
        rest += weight - 1.0;
        light = next(light + 1, false);
      } else {
        const std::size_t filler = next(heavy + 1, true);
        if (filler == n) rest = 1.0;  // exact up to rounding
        const double given = set(heavy, rest, filler < n ? filler : heavy);
        gain_ = given;
        if (filler < n) rest += scaled(filler) - 1.0;
        heavy = filler;
      }
    }
    // The remaining entries weigh 1 up to rounding. Entries of weight 0 must not be sampled all the same.
    for (; heavy < n; heavy = next(heavy + 1, true), gain_ = 0.0) set(heavy, 1.0, heavy);
    for (; light < n; light = next(light + 1, false)) {
      if (scaled(light) > 0.0)
        set(light, 1.0, light);
      else
        table_[fallback].probability += static_cast<float>(set(light, 0.0, fallback) / static_cast<double>(n));
    }
    return std::move(table_);
  }

 private:
  double scaled(std::size_t i) const {
    const float w = weights_[i];
    return w > 0.0f && w <= std::numeric_limits<float>::max() ? w * scale_ : 0.0;
  }
  std::size_t next(std::size_t i, bool heavy) const {
    while (i < weights_.size() && (scaled(i) > 1.0) != heavy) ++i;
    return i;
  }
  // Completes entry i and returns the weight that its alias gets from it. The probability of a heavy entry includes the
  // weight that it gained from earlier entries.
  double set(std::size_t i, double keep, std::size_t alias) {
    shared::AliasEntry& entry = table_[i];
    entry.keep = static_cast<float>(keep);
    entry.alias = static_cast<shared::uint>(alias);
    const double gained = scaled(i) > 1.0 ? gain_ : 0.0;
    entry.probability = static_cast<float>((entry.keep + gained) / static_cast<double>(table_.size()));
    return alias == i ? 0.0 : 1.0 - static_cast<double>(entry.keep);
  }

  std::span<const float> weights_;
  double scale_;
  double gain_ = 0.0;  // weight gained by the current heavy entry, in units of 1/n
  std::vector<shared::AliasEntry> table_;
};

}  // namespace

std::vector<shared::AliasEntry> buildAliasTable(std::span<const float> weights) {
  double total = 0.0;
  for (const float w : weights)
    if (w > 0.0f && w <= std::numeric_limits<float>::max()) total += w;
  if (total <= 0.0) return {};
  return Sweep(weights, total).run();
}

}  // namespace quintet::render
