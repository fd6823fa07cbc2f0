// SPDX-License-Identifier: Apache-2.0
// For intersection, any-hit and closest-hit shaders: geometry and primitive of the candidate or the hit.
#ifndef QUINTET_HIT_GEOMETRY_GLSL
#define QUINTET_HIT_GEOMETRY_GLSL

#include "hit_indices.glsl"

// Hit kinds that the intersection shaders of solids and CSG trees report.
const uint kHitEntering = 1u;
const uint kHitLeaving = 2u;

HitIndices driverHitIndices() {
  return HitIndices(uint(gl_InstanceCustomIndexEXT), uint(gl_GeometryIndexEXT), uint(gl_PrimitiveID));
}

// Index of the triangle (box, solid, CSG tree) in the scene's order.
uint hitTriangle(GeometryData geometry) { return scenePrimitive(geometry, uint(gl_PrimitiveID)); }

// The custom_index of the scene file; gl_InstanceCustomIndexEXT is the index of the instance in the scene.
uint instanceCustomIndex() { return InstanceArray(frame.instances).at[gl_InstanceCustomIndexEXT].customIndex; }

GeometryData hitGeometry() { return geometryOf(uint(gl_InstanceCustomIndexEXT), uint(gl_GeometryIndexEXT)); }

// The box of the candidate or the hit in object space, as the scene declares it. For intersection shaders, and for the
// other hit shaders on boxes; triangles have no boxes.
BoxData hitBox() {
  const GeometryData geometry = hitGeometry();
  return BoxArray(geometry.boxes).at[hitTriangle(geometry)];
}

#endif
