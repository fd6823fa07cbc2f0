// SPDX-License-Identifier: Apache-2.0
// Alpha in any-hit shaders on triangles: the coverage of the surface, and the stochastic alpha test (coverage.glsl).
#ifndef QUINTET_ALPHA_GLSL
#define QUINTET_ALPHA_GLSL

#include "coverage.glsl"
#include "hit.glsl"

// Coverage of the candidate: 0 or 1 for alpha mask, alpha for blend, 1 for all other materials.
float alphaCoverage(vec2 barycentric) { return triangleCoverage(driverHitIndices(), barycentric); }

// True if the candidate must be ignored: alpha mask below its cutoff, or blend with probability 1 - alpha.
bool alphaRejects(vec2 barycentric, uint seed) { return triangleRejected(driverHitIndices(), barycentric, seed); }

#endif
