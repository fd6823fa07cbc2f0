#include "render/alias_table.h"

#include <limits>
#include <utility>

namespace quintet::render {
namespace {

// The pairing of M. Vose, "A Linear Algorithm for Generating Random Numbers with a Given Distribution" (1991), in
// the sweeping order of L. Hübschle-Schneider & P. Sanders, "Parallel Weighted Random Sampling" (2022),
// section 4.1: one cursor walks over the light entries (scaled weight ≤ 1), one over the heavy ones, each
// once through memory and without work lists. Light entries are filled up by the current heavy one; when
// that has at most 1 left, it becomes light itself and the next heavy entry fills it up.
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
        if (filler == n) rest = 1.0;  // up to rounding
        const double given = set(heavy, rest, filler < n ? filler : heavy);
        gain_ = given;
        if (filler < n) rest += scaled(filler) - 1.0;
        heavy = filler;
      }
    }
    // What is left weighs 1 up to rounding; entries of weight 0 must not be drawn all the same.
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
  // Completes entry i; returns what its alias gets from it. A heavy entry's own probability includes what it has
  // gained from the entries before it.
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
  double gain_ = 0.0;  // of the current heavy entry, in units of 1/n
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
