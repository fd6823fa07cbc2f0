// translate, rotate, scale, matrix: the keys that place something.
#ifndef QUINTET_SCENE_SCENE_TOML_TRANSFORM_H
#define QUINTET_SCENE_SCENE_TOML_TRANSFORM_H

#include "scene/scene.h"
#include "scene/scene_toml_reader.h"

namespace quintet::scene {

// rotate = [x, y, z] (degrees, about x, then y, then z) | { axis = [...], degrees = a } | { quaternion = [x, y, z, w] }
quat readRotation(const TomlReader& reader, const TomlValue& value);

// translate, rotate, scale of `reader`; absent ones are those of `fallback`, whose frame stays.
Keyframe readParts(TomlReader& reader, const Keyframe& fallback = {});

// translate · rotate · scale, or matrix; the identity without any of them. Has a finite inverse.
mat4 readTransform(TomlReader& reader);

// Refuses a matrix that is not finite or has no inverse in single precision.
void checkInvertible(const TomlReader& reader, const TomlValue& at, const mat4& matrix);

}  // namespace quintet::scene
#endif
