// What hit and miss shaders hand back: which surface, not what it looks like. The program owns the path
// loop and asks surface.glsl for the rest.
#ifndef QUINTET_PAYLOAD_GLSL
#define QUINTET_PAYLOAD_GLSL

struct HitPayload {
  float t;           // ray parameter; < 0: miss
  uint instance;     // InstanceData index
  uint geometry;     // geometry index in the instance's mesh
  uint primitive;    // triangle index in the scene's order
  vec2 barycentric;  // weights of vertices 1 and 2
  uint seed;         // in: random bits of this ray, for stochastic alpha
};

struct ShadowPayload {
  uint visible;  // set by the miss shader
  uint seed;     // in: as above
};

#endif
