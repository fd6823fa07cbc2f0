// glTF materials with the extensions that Quintet understands.
#ifndef QUINTET_SCENE_GLTF_MATERIAL_H
#define QUINTET_SCENE_GLTF_MATERIAL_H

#include <vector>

#include "scene/gltf_texture.h"

namespace quintet::scene {

// One for each of the file's materials, in its order. Factors outside their range are clamped and reported.
std::vector<Material> readMaterials(const Document&, TextureTable&, Report&);

}  // namespace quintet::scene
#endif
