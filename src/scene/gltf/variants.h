// SPDX-License-Identifier: Apache-2.0
// Material variants of a glTF file (KHR_materials_variants): named sets of materials for its primitives.
#ifndef QUINTET_SCENE_GLTF_VARIANTS_H
#define QUINTET_SCENE_GLTF_VARIANTS_H

#include <string>
#include <vector>

#include "scene/gltf/document.h"

namespace quintet::scene {

// Returns the names in the order of the file.
std::vector<std::string> variantNames(const Document& document);

// Gives each primitive its material of the variant; primitives that the variant does not name keep theirs. Throws
// UsageError with the list of names if no variant has this name.
void selectVariant(Document& document, const std::string& name);

}  // namespace quintet::scene
#endif
