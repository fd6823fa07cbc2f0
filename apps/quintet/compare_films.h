// `quintet compare --z-test`: are two films the same picture, up to noise?
#ifndef QUINTET_APP_COMPARE_FILMS_H
#define QUINTET_APP_COMPARE_FILMS_H

#include <string>
#include <vector>

#include "render/film_ztest.h"

namespace quintet::app {

struct FilmComparison {
  std::string a, b;                    // files
  std::string output;                  // PNG of the blocks' |t|; empty: none
  std::vector<std::string> mayDiffer;  // facts of the identity, or their first words, besides seed and samples planned
  bool json = false;
  render::ZTestOptions test;
};

// Writes the report to standard output. Throws FileError for files that are no films, or not of the same picture by their
// identities, and Error if the test rejects.
void compareFilms(const FilmComparison& comparison);

}  // namespace quintet::app
#endif
