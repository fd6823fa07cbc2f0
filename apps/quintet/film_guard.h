// Films that do not belong together, and films that would be lost.
#ifndef QUINTET_APP_FILM_GUARD_H
#define QUINTET_APP_FILM_GUARD_H

#include <filesystem>
#include <string>
#include <vector>

#include "render/film_file.h"

namespace quintet::app {

// If `found`, the content of `file`, is of another rendering than `identity`: each difference on standard error, one
// line each ("quintet: FILE: seed: 3 in the checkpoint, 4 here"), then a FileError that ends with `advice`. `where`,
// `here`: what the lines call the two.
struct IdentityCheck {
  std::filesystem::path file;
  std::string where, here;
  std::string problem;
};
void refuseOther(const render::FilmFacts& found, const render::FilmFacts& identity, const IdentityCheck& check);

// Throws FileError where `file` holds samples that a film of this identity and these samples would not: its content
// would be lost. An adaptive rendering, whose numbers are not known before, has no cells in `samples`.
void refuseLoss(const std::filesystem::path& file, const render::FilmFacts& identity,
                const render::SampleCounts& samples);

}  // namespace quintet::app
#endif
