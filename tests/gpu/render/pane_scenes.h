// SPDX-License-Identifier: Apache-2.0
// Panes, alpha materials and bubbles for the tests of light through them.
#ifndef QUINTET_TESTS_GPU_RENDER_PANE_SCENES_H
#define QUINTET_TESTS_GPU_RENDER_PANE_SCENES_H

#include "rendered_image.h"

namespace quintet::test {

// Returns the material of a smooth thin wall.
scene::Material pane(const vec3& color);
// Returns the material with this alpha.
scene::Material veil(scene::Material material, float alpha, scene::AlphaMode mode);

// Adds an instance of a sphere with thin walls, as a solid or as a CSG tree.
void addBubble(SceneBuilder& scene, const scene::Material& material, const vec3& center, float radius, bool tree);

}  // namespace quintet::test
#endif
