// SPDX-License-Identifier: Apache-2.0
// EXT_lights_image_based: the light of the scene becomes its environment. Level 0 of the cube map, which is not blurred, is
// converted to an equirectangular image. The other levels and the irradiance coefficients are blurred versions of the
// same light for rasterizers, and are not used.
#ifndef QUINTET_SCENE_GLTF_IMAGE_BASED_LIGHT_H
#define QUINTET_SCENE_GLTF_IMAGE_BASED_LIGHT_H

#include <array>
#include <set>

#include "scene/gltf/document.h"
#include "scene/model/scene.h"

namespace quintet::scene {

struct ImageBasedLight {
  int light = kNone;          // index in the extension, or kNone if the scene has none
  std::set<int> images;       // of the file, used
  std::set<int> prefiltered;  // of the file, not used
  Environment environment;    // present unless there is no light, or its images are missing
};

// `scene`: index of the chosen scene of the file, or kNone. Decodes the images. Throws FileError and MemoryError; if
// `replaceMissing`, images that cannot be read give a line in the report and no environment.
ImageBasedLight readImageBasedLight(const Document&, int scene, bool replaceMissing, Report&);

// Returns an equirectangular image (scene::Environment) with linear floats, 4 times as wide and 2 times as high as a face,
// but at most 4096 x 2048. `faces`: linear RGB floats, square and of equal size, in the order +x, -x, +y, -y, +z, -z. Each
// shows what is seen from the center with +y up; for ±y, up is ∓z. `worldFromLight`: rotation of the light.
io::Image equirectangularFromCube(const std::array<io::Image, 6>& faces, const quat& worldFromLight);

}  // namespace quintet::scene
#endif
