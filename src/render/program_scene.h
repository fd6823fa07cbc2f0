// The scene for a program that is run without one.
#ifndef QUINTET_RENDER_PROGRAM_SCENE_H
#define QUINTET_RENDER_PROGRAM_SCENE_H

#include "program/program.h"
#include "scene/default_scene.h"

namespace quintet::render {

// What of the built-in scene the program's hit groups can meet.
scene::DefaultSceneOptions defaultSceneOptions(const program::Program& program);

// The one that the program brings (Program::scene), else scene::defaultScene with what its hit groups can meet.
// Throws FileError for a scene file that is wrong.
scene::Scene programScene(const program::Program& program);

}  // namespace quintet::render
#endif
