// The layers of a rendering in a film file, so that `quintet merge` writes them as the rendering would have.
#ifndef QUINTET_APP_AOV_NOTES_H
#define QUINTET_APP_AOV_NOTES_H

#include <string>
#include <vector>

#include "aov.h"
#include "render/film_file.h"

namespace quintet::app {

void addAovNotes(render::FilmFacts& notes, const std::vector<AovLayer>& layers, const CoverageNames& names);

// What was noted; nothing where no layers were. Throws UsageError where that cannot be read, or made of this film.
std::vector<AovLayer> readAovLayers(const render::FilmFacts& notes, const render::FilmState& film);
CoverageNames readCoverageNames(const render::FilmFacts& notes);

// `notes` say the layers of both afterwards, in the program's order. Both are of films like this one.
void joinAovNotes(render::FilmFacts& notes, const render::FilmFacts& others, const render::FilmState& film);

}  // namespace quintet::app
#endif
