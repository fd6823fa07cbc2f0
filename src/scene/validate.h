// Consistency of a scene: what every importer and every hand-made scene owes the renderer.
#ifndef QUINTET_SCENE_VALIDATE_H
#define QUINTET_SCENE_VALIDATE_H

#include "scene/scene.h"

namespace quintet::scene {

// Throws Error, naming the object ("meshes[2].geometries[0].normals: 3 elements for 4 vertices"), at the first
// index out of range, attribute of the wrong length, position or transform that is not finite, transform without an
// inverse, tree that cannot be evaluated (procedural.h), value that does not fit its bits, keyframes that do not
// ascend or turn a scale's sign, texture without an image.
void validate(const Scene&);

}  // namespace quintet::scene
#endif
