// A name for what a scene contains.
#ifndef QUINTET_SCENE_CONTENT_HASH_H
#define QUINTET_SCENE_CONTENT_HASH_H

#include "base/hash.h"
#include "scene/scene.h"

namespace quintet::scene {

// Equal for equal scenes on every machine of the same byte order. Covers all that can reach a picture and
// the objects' names; not the report and not the scene's own name, which depend on how it was stored.
Hash contentHash(const Scene&);
// Of light around a scene, wherever it came from.
Hash contentHash(const Environment&);

}  // namespace quintet::scene
#endif
