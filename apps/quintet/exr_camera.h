// The camera in an OpenEXR file: the standard attributes worldToCamera and worldToNDC, and notes in a film from which
// they are made later. docs/aov.md says what they mean.
#ifndef QUINTET_APP_EXR_CAMERA_H
#define QUINTET_APP_EXR_CAMERA_H

#include <optional>

#include "io/exr.h"
#include "program/program.h"
#include "render/camera.h"
#include "render/film_file.h"

namespace quintet::app {

// Nothing for programs that accumulate themselves, as those of the lectures: they bring cameras of their own.
std::optional<render::CameraMatrices> shownCamera(const program::Program& program, const scene::Camera& camera,
                                                  uvec2 size);

void addCamera(io::ExrPicture& picture, const std::optional<render::CameraMatrices>& matrices);

void addCameraNotes(render::FilmFacts& notes, const std::optional<render::CameraMatrices>& matrices);
// Nothing where there are none. Throws UsageError for notes that are no matrices.
std::optional<render::CameraMatrices> readCameraNotes(const render::FilmFacts& notes);
// Takes those of another film of the same rendering, if it has more of them.
void joinCameraNotes(render::FilmFacts& notes, const render::FilmFacts& others);

}  // namespace quintet::app
#endif
