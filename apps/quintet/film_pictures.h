// Pictures of a film that was read from a file: those that the rendering itself would have written.
#ifndef QUINTET_APP_FILM_PICTURES_H
#define QUINTET_APP_FILM_PICTURES_H

#include "merge_options.h"
#include "metadata.h"
#include "render/film_file.h"

namespace quintet::app {

// Writes the first output, or all; names them in `record`, which is filled otherwise.
void writePictures(const render::FilmFile& file, const MergeOptions& options, RenderRecord& record);

}  // namespace quintet::app
#endif
