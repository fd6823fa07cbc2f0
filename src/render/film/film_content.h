// SPDX-License-Identifier: Apache-2.0
// What a film file holds: the film, and the facts about its render as names and values. film_file.h reads and writes it as a
// whole, film_reader.h as a stream.
#ifndef QUINTET_RENDER_FILM_FILM_CONTENT_H
#define QUINTET_RENDER_FILM_FILM_CONTENT_H

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "render/film/film_state.h"

namespace quintet::render {

// Names and values in display order: {"seed", "3"}. Names are unique.
using FilmFacts = std::vector<std::pair<std::string, std::string>>;

const std::string* findFact(const FilmFacts& facts, const std::string& name);  // null if the name is missing

struct FilmFile {
  FilmFacts identity;  // facts that decide the values of samples: films belong together only if all of them are equal
  FilmFacts notes;     // all other facts: file names, device, how to display the image
  FilmState film;
  // Unfinished adaptive sampling: the batches that each cell shall have (planCells), as decided at an earlier state of
  // this film. The next decision follows once this plan is complete. Empty if nothing is decided yet.
  std::vector<std::uint32_t> plan;
};

// A name whose values differ in two identities; the value is null on a side that lacks the name.
struct FactDifference {
  std::string name;
  const std::string* left = nullptr;
  const std::string* right = nullptr;
};
std::vector<FactDifference> differences(const FilmFacts& left, const FilmFacts& right);

}  // namespace quintet::render
#endif
