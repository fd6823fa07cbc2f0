// SPDX-License-Identifier: Apache-2.0
// A hash of the contents of a scene. Films store it, so that it must not change between versions.
#ifndef QUINTET_SCENE_MODEL_CONTENT_HASH_H
#define QUINTET_SCENE_MODEL_CONTENT_HASH_H

#include "base/hash.h"
#include "scene/model/scene.h"

namespace quintet::scene {

// Equal for equal scenes on all machines of the same byte order. Covers everything that can affect an image, and the
// names of objects. Excludes the report, the timings and the name of the scene, which depend on how it was stored.
Hash contentHash(const Scene&);
// Hash of an environment, independent of its source.
Hash contentHash(const Environment&);

}  // namespace quintet::scene
#endif
