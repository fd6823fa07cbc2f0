// SPDX-License-Identifier: Apache-2.0
// glTF materials with the supported extensions.
#ifndef QUINTET_SCENE_GLTF_MATERIAL_H
#define QUINTET_SCENE_GLTF_MATERIAL_H

#include <vector>

#include "scene/gltf/texture.h"

namespace quintet::scene {

// One material per material of the file, in the same order. Factors outside their range are clamped and reported.
std::vector<Material> readMaterials(const Document&, TextureTable&, Report&);

}  // namespace quintet::scene
#endif
