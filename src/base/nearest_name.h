// "Did you mean ...?" for a name that is not there.
#ifndef QUINTET_BASE_NEAREST_NAME_H
#define QUINTET_BASE_NEAREST_NAME_H

#include <string>
#include <vector>

namespace quintet {

// The candidate of the smallest edit distance to `name`; empty if none is near (2 edits, or half of a longer name).
std::string nearestName(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace quintet
#endif
