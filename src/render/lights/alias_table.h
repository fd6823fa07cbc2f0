// SPDX-License-Identifier: Apache-2.0
// Walker/Vose alias tables, which sample one of n entries with given probabilities in constant time.
#ifndef QUINTET_RENDER_LIGHTS_ALIAS_TABLE_H
#define QUINTET_RENDER_LIGHTS_ALIAS_TABLE_H

#include <span>
#include <vector>

#include "quintet/shared/lights.h"

namespace quintet::render {

// Returns one entry per weight, which is sampled in proportion to it. Entries whose weight is zero, negative or not
// finite are never sampled: they have probability 0 and are the alias of no entry. AliasEntry::probability is the exact
// probability with the rounded `keep` values, so an estimator divided by it is unbiased. The table is empty if no
// weight is positive. O(n).
std::vector<shared::AliasEntry> buildAliasTable(std::span<const float> weights);

}  // namespace quintet::render
#endif
