// SPDX-License-Identifier: Apache-2.0
// The list of everything that a glTF file contains, for the report: used, unused, repaired or ignored, with the reason.
#ifndef QUINTET_SCENE_GLTF_INVENTORY_H
#define QUINTET_SCENE_GLTF_INVENTORY_H

#include "scene/gltf/animations.h"
#include "scene/gltf/document.h"
#include "scene/gltf/image_based_light.h"
#include "scene/gltf/nodes.h"
#include "scene/gltf/texture.h"

namespace quintet::scene {

// Fills report.features. The readers have added their lines to `ignored` and `repaired` before; this adds lines for what
// no reader saw: extensions and properties that are not supported. `materials` are those of the file.
void completeReport(const Document&, const NodeTree&, const TextureTable&, const PlayedAnimation&,
                    const std::vector<Material>& materials, const ImageBasedLight&, Report&);

// The images of these uses could not be read: adds a line "LOCATION: PROBLEM" to `ignored` and changes the features.
struct MissingImage {
  int image = kNone;    // index in Document::images
  std::string problem;  // one sentence without a period
};
void reportMissingImages(const Document&, const std::vector<MissingImage>&, Report&);

}  // namespace quintet::scene
#endif
