// For intersection, any-hit and closest-hit shaders: what the built-ins say of the candidate or the hit.
#ifndef QUINTET_HIT_GEOMETRY_GLSL
#define QUINTET_HIT_GEOMETRY_GLSL

#include "frame.glsl"

// Hit kinds of solids and trees, as their intersection shaders report them.
const uint kHitEntering = 1u;
const uint kHitLeaving = 2u;

// Index of the triangle (box, solid, tree) that the built-ins name, in the scene's order.
uint hitTriangle(GeometryData geometry) {
  return geometry.primitiveMap != 0ul ? UintArray(geometry.primitiveMap).at[gl_PrimitiveID] : uint(gl_PrimitiveID);
}

// The instance's own index of scenes (custom_index); gl_InstanceCustomIndexEXT is its position in the scene.
uint instanceCustomIndex() { return InstanceArray(frame.instances).at[gl_InstanceCustomIndexEXT].customIndex; }

GeometryData hitGeometry() {
  const uint first = InstanceArray(frame.instances).at[gl_InstanceCustomIndexEXT].firstGeometry;
  return GeometryArray(frame.geometries).at[first + uint(gl_GeometryIndexEXT)];
}

#endif
