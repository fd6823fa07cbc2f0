// SPDX-License-Identifier: Apache-2.0
// Consistency check of a scene: the properties that the renderer relies on.
#ifndef QUINTET_SCENE_MODEL_VALIDATE_H
#define QUINTET_SCENE_MODEL_VALIDATE_H

#include <cstddef>

#include "scene/model/scene.h"

namespace quintet::scene {

// Throws Error with the name of the object ("meshes[2] 'chair'.geometries[0].normals: 3 elements for 4 vertices") for the first
// index out of range, attribute of the wrong length, position or transform that is not finite, singular transform,
// invalid CSG tree (procedural.h), material property or cone angle out of its range (scene.h), value that does not fit its bits, scale of a normal map, alpha cutoff or
// texture transform that is not finite, keyframes that do not ascend or whose scale
// changes its sign, texture without an image.
void validate(const Scene&);

// The same for one object, and the objects that it refers to by index.
void validateMesh(const Scene&, std::size_t index);
void validateInstance(const Scene&, std::size_t index);
void validateMaterial(const Scene&, std::size_t index);
void validateTexture(const Scene&, std::size_t index);  // with its image
void validateCamera(const Scene&, std::size_t index);
void validateLight(const Scene&, std::size_t index);
void validateEnvironment(const Scene&);

}  // namespace quintet::scene
#endif
