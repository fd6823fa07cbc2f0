// Walker/Vose alias tables: drawing one of n entries with given probabilities in constant time.
#ifndef QUINTET_RENDER_ALIAS_TABLE_H
#define QUINTET_RENDER_ALIAS_TABLE_H

#include <span>
#include <vector>

#include "quintet/shared/lights.h"

namespace quintet::render {

// One entry per weight, drawn in proportion to it. Weights that are zero, negative or not finite are
// never drawn (probability 0, and no other entry's alias). AliasEntry::probability is what the table
// really does with its rounded `keep`s, so an estimator divided by it has no bias. No positive
// weight: an empty table. O(n).
std::vector<shared::AliasEntry> buildAliasTable(std::span<const float> weights);

}  // namespace quintet::render
#endif
