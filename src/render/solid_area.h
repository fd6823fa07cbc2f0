// The area of a solid's surface under an affine transform: for the power of an emissive one.
#ifndef QUINTET_RENDER_SOLID_AREA_H
#define QUINTET_RENDER_SOLID_AREA_H

#include "scene/procedural.h"

namespace quintet::render {

// Exact for boxes and where the transform keeps shapes; else by quadrature, some 1e-3 off at moderate stretch.
double solidArea(const scene::Primitive& primitive, const glm::dmat3& worldFromObject);

}  // namespace quintet::render
#endif
