// The coding of the light tree's nodes (shared::LightNode): bounds of lights in few bits, rounded so that they hold all
// that the bounds did.
#ifndef QUINTET_RENDER_LIGHT_NODE_H
#define QUINTET_RENDER_LIGHT_NODE_H

#include "quintet/shared/frame.h"
#include "render/light_bounds.h"

namespace quintet::render {

// The node of these bounds; link is left for the caller. The cone is as wide as its coding asks for.
shared::LightNode packLightNode(const LightBounds& bounds);
// The axis as the device sees it.
vec3 unpackLightAxis(std::uint32_t axis);

}  // namespace quintet::render
#endif
