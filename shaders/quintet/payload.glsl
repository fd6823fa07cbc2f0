// SPDX-License-Identifier: Apache-2.0
// Payloads of hit and miss shaders. They identify the surface but hold no shading data. The ray generation shader runs
// the path loop and gets the shading data from surface.glsl.
#ifndef QUINTET_PAYLOAD_GLSL
#define QUINTET_PAYLOAD_GLSL

struct HitPayload {
  float t;           // ray parameter; < 0: miss
  uint instance;     // InstanceData index
  uint geometry;     // geometry index in the instance's mesh
  uint primitive;    // index of the triangle, the solid or the CSG tree in the scene's order
  vec2 barycentric;  // weights of vertices 1 and 2; solids: the point on the canonical solid (procedural/point.glsl)
#ifndef QUINTET_NO_PROCEDURALS
  uint part;         // solids: solid of the CSG tree, face and side (procedural/point.glsl)
#endif
#ifndef QUINTET_NO_SEEDS
  uint seed;         // in: random bits of this ray, for stochastic alpha
#endif
};

struct ShadowPayload {
  uint visible;        // set by the miss shader
#ifndef QUINTET_NO_SEEDS
  uint seed;           // in: same
#endif
#ifndef QUINTET_NO_TRANSMITTANCE
  vec3 transmittance;  // any-hit shaders multiply it by the transmittance of their surface
#endif
};

// The seed of a payload. Scenes without alpha have none, because a larger payload is slower.
#ifdef QUINTET_NO_SEEDS
#define raySeed(payload) 0u
#define setRaySeed(payload, bits)
#else
#define raySeed(payload) payload.seed
#define setRaySeed(payload, bits) payload.seed = bits
#endif

#endif
