// SPDX-License-Identifier: Apache-2.0
// Classes of surfaces by the effect of their material on a ray, which decide the any-hit shaders that a geometry needs:
//   alpha-tested     coverage below 1 is possible (alpha mode mask or blend)
//   invisible        the coverage is 0 everywhere
//   pane             thin-walled (KHR_materials_transmission with thickness 0) and smooth, so that light can pass
//                    straight through, such as window glass
//   medium           the boundary of a closed solid that light enters, such as glass or water
//   shadow-tinting   a shadow ray can pass and keep a part of its light: panes and alpha mode blend
// A surface that is neither alpha-tested nor a pane nor shadow-tinting needs no any-hit shader. A surface whose material
// is animated is in the classes to which it belongs at any time.
#ifndef QUINTET_SCENE_MODEL_SURFACE_CLASS_H
#define QUINTET_SCENE_MODEL_SURFACE_CLASS_H

#include "scene/model/scene.h"

namespace quintet::scene {

// A lobe with alpha = roughness² below 5e-4 (kDeltaAlpha) is a delta lobe; rounded up.
inline constexpr float kPaneAlpha = 5.001e-4f;

// True if the alpha mode is mask or blend and the alpha can be below 1, or below a cutoff above 1.
bool needsAlphaTest(const Scene& scene, const Geometry& geometry);
bool needsAlphaTest(const Scene& scene, const PrimitiveSet& set);

// True if the surface is missing everywhere, whatever its textures and vertex colors: they can only reduce the alpha.
bool isInvisible(const Material& material);

// True if the material is a pane, at least in parts: a texture can vary the roughness.
bool isPane(const Material& material);
bool isPane(const Scene& scene, const Geometry& geometry);
bool isPane(const Scene& scene, const PrimitiveSet& set);

// True if light can enter a closed solid of this material: transmission, also diffuse, and a thickness.
bool isMedium(const Material& material);
// True if light also scatters in this solid.
bool scatters(const Material& material);

// True if the surface is a pane, or has alpha mode blend and an alpha that can be below 1.
bool tintsShadows(const Scene& scene, const Geometry& geometry);
bool tintsShadows(const Scene& scene, const PrimitiveSet& set);

}  // namespace quintet::scene
#endif
