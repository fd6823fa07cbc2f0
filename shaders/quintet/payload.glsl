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
#ifndef QUINTET_NO_SEEDS
  uint seed;         // in: random bits of this ray, for stochastic alpha
#endif
};

struct ShadowPayload {
  uint visible;        // set by the miss shader
#ifndef QUINTET_NO_SEEDS
  uint seed;           // in: as above
#endif
#ifndef QUINTET_NO_TRANSMITTANCE
  vec3 transmittance;  // any-hit shaders multiply it by what their surface lets through
#endif
};

// A payload's seed: scenes without alpha have none, and what travels with a ray costs time.
#ifdef QUINTET_NO_SEEDS
#define raySeed(payload) 0u
#define setRaySeed(payload, bits)
#else
#define raySeed(payload) payload.seed
#define setRaySeed(payload, bits) payload.seed = bits
#endif

#endif
