// One analytic solid, as an item of a set or a leaf of a tree.
#ifndef QUINTET_SCENE_SCENE_TOML_SOLID_H
#define QUINTET_SCENE_SCENE_TOML_SOLID_H

#include "scene/scene_toml_context.h"

namespace quintet::scene {

// The keys of the solid's size and place, and `material`:
//   T(center) · translate · rotate · scale · (the solid about the origin)
// `outer` is multiplied from the left; `material` counts if there is no such key. Refuses other keys.
Primitive readSolid(SceneTomlContext&, TomlReader& reader, PrimitiveType type, const mat4& outer, int material);

}  // namespace quintet::scene
#endif
