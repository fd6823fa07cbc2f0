// What hit and miss shaders hand back: which surface, not what it looks like. The program owns the path
// loop and asks surface.glsl for the rest.
#ifndef QUINTET_PAYLOAD_GLSL
#define QUINTET_PAYLOAD_GLSL

struct HitPayload {
  float t;           // ray parameter; < 0: miss
  uint instance;     // InstanceData index
  uint geometry;     // geometry index in the instance's mesh
  uint primitive;    // index of the triangle, the solid or the tree in the scene's order
  vec2 barycentric;  // weights of vertices 1 and 2; solids: the point on the canonical solid (procedural/point.glsl)
#ifndef QUINTET_NO_PROCEDURALS
  uint part;         // solids: which one of a tree, face and side (procedural/point.glsl)
#endif
  uint seed;         // in: random bits of this ray, for stochastic alpha
};

struct ShadowPayload {
  uint visible;  // set by the miss shader
  uint seed;     // in: as above
};

#endif
