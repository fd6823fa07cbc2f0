// Pictures of a film that was read from a file: those that the rendering itself would have written.
#ifndef QUINTET_APP_FILM_PICTURES_H
#define QUINTET_APP_FILM_PICTURES_H

#include "merge_options.h"
#include "metadata.h"
#include "render/film_file.h"

namespace quintet::app {

// Throws UsageError where the notes on how the film is shown are not those of a rendering, whoever wrote them.
void checkShown(const render::FilmFile& file);

// A picture of each output, now or when it was rendered.
bool showsAllOutputs(const render::FilmFile& file, const MergeOptions& options);

float exposureOf(const render::FilmFile& file);  // stops, as rendered

// Notes in the film what the options say of how it is shown, for the picture that is made of it later.
void keepShown(render::FilmFile& file, const MergeOptions& options);

// Writes the first output, or all; names them in `record`, which is filled otherwise.
void writePictures(const render::FilmFile& file, const MergeOptions& options, RenderRecord& record);

}  // namespace quintet::app
#endif
