// SPDX-License-Identifier: Apache-2.0
#include "render/film/film_content.h"

#include <algorithm>

namespace quintet::render {

const std::string* findFact(const FilmFacts& facts, const std::string& name) {
  const auto found = std::ranges::find(facts, name, &FilmFacts::value_type::first);
  return found == facts.end() ? nullptr : &found->second;
}

std::vector<FactDifference> differences(const FilmFacts& left, const FilmFacts& right) {
  std::vector<FactDifference> result;
  for (const auto& [name, value] : left) {
    const std::string* other = findFact(right, name);
    if (!other || *other != value) result.push_back({name, &value, other});
  }
  for (const auto& [name, value] : right)
    if (!findFact(left, name)) result.push_back({name, nullptr, &value});
  return result;
}

}  // namespace quintet::render
