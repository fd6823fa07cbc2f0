// The layers of a rendering in a film file, so that `quintet merge` writes them as the rendering would have.
#ifndef QUINTET_APP_AOV_NOTES_H
#define QUINTET_APP_AOV_NOTES_H

#include <string>
#include <vector>

#include "aov.h"
#include "render/film_file.h"

namespace quintet::app {

void addAovNotes(render::FilmFacts& notes, const std::vector<AovLayer>& layers, const CoverageNames& names);

// What was noted; nothing where no layers were. Throws UsageError where it fits no film with so many outputs.
std::vector<AovLayer> readAovLayers(const render::FilmFacts& notes, std::size_t outputCount);
CoverageNames readCoverageNames(const render::FilmFacts& notes);

}  // namespace quintet::app
#endif
