// Panes, veils and bubbles for the tests of light through them.
#ifndef QUINTET_TESTS_GPU_RENDER_PANE_SCENES_H
#define QUINTET_TESTS_GPU_RENDER_PANE_SCENES_H

#include "picture.h"

namespace quintet::test {

// A smooth thin wall.
scene::Material pane(const vec3& color);
// The material with alpha.
scene::Material veil(scene::Material material, float alpha, scene::AlphaMode mode);

// A sphere of thin walls with an instance of its own, as a solid or as a tree of solids.
void addBubble(SceneBuilder& scene, const scene::Material& material, const vec3& center, float radius, bool tree);

}  // namespace quintet::test
#endif
