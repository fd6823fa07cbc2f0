// SPDX-License-Identifier: Apache-2.0
// Samples one light of many, by a binary tree of bounds: A. Conty Estevez and C. Kulla, "Importance Sampling of Many
// Lights with Adaptive Tree Splitting" (2018), section 5, without the splitting. At each node the probability of a child
// is proportional to an estimate of the irradiance from its lights. The index of a leaf determines the path from the root
// to it. The probability of a known light uses the same arithmetic as sampling, so both agree exactly.
#ifndef QUINTET_LIGHTS_TREE_GLSL
#define QUINTET_LIGHTS_TREE_GLSL

#extension GL_EXT_control_flow_attributes : enable
#include "../features.glsl"
#include "../frame.glsl"
#include "../sampling/hash.glsl"

// The point for which a light is sampled. The probability of a light depends on all members. For the MIS weight of a
// light that a BSDF sample has hit, use the context of the vertex where the sample started.
struct LightSampleContext {
  vec3 position;
  vec3 normal;  // world, unit, geometric; 0 means no surface
  bool opaque;  // light from behind does not contribute
};

// Context of a point without a surface, such as in a volume.
LightSampleContext lightSampleContext(vec3 position) { return LightSampleContext(position, vec3(0.0), false); }

// Tolerance for rounding errors of cosines at the bounds, so that no light that can contribute has probability 0.
const float kLightSlack = 1e-3;
// Lower limits of the cosines at the surface, because the shading normal differs from the geometric one, and at the light.
const float kLeastFacing = 0.0625;
const float kLeastEmission = 0.01;
// Weight of the cosine towards the center against the largest cosine; measured, see docs/measurements.md.
const float kLightLikely = 0.75;
// Lower limit of the squared distance, relative to the squared radius; measured, too.
const float kNearest = 0.125;
// Least probability of each child at a kLightNodeShare, for opaque and for transmissive surfaces. Narrow lobes of glass
// find large panels by BSDF sampling, but not the sun.
const float kLightShare = 0.15;
const float kLightShareTransmissive = 0.5;

// Returns cos(max(0, a - b)) for two angles in [0, pi], given their cosines.
float cosineOfDifference(float a, float b) {
  return a >= b ? 1.0 : a * b + sqrt(max(0.0, (1.0 - a * a) * (1.0 - b * b)));
}

vec3 lightAxis(uint bits) {
  const vec2 v = unpackSnorm2x16(bits);
  const float z = 1.0 - abs(v.x) - abs(v.y);
  const float fold = max(-z, 0.0);
  return normalize(vec3(v.x + (v.x >= 0.0 ? -fold : fold), v.y + (v.y >= 0.0 ? -fold : fold), z));
}

// Estimates the irradiance from the lights of a node; 0 only if none of them can contribute.
float lightImportance(LightNode node, LightSampleContext context) {
  const bool infinite = (node.link & kLightNodeInfinite) != 0u;
  const vec3 axis = lightAxis(node.axis);
  const vec2 cone = unpackSnorm2x16(node.cone);
  const float cosThetaO = cone.x;
  const float cosThetaE = cone.y;
  const vec3 d = infinite ? axis : node.center - context.position;
  const float squared = dot(d, d);
  const float radius = node.radius + 5e-7 * (abs(context.position.x) + abs(context.position.y) + abs(context.position.z));
  const vec3 wi = d * inversesqrt(max(squared, 1e-37));
  // Cosine of the angle around wi that contains the lights: the angle of the ball, or all directions from inside.
  float within = squared > radius * radius ? sqrt(1.0 - radius * radius / squared) : -1.0;
  if (infinite) within = cosThetaO;

  // Each cosine: towards the center, then the largest in the ball.
  float facing = context.normal == vec3(0.0) ? 1.0 : dot(context.normal, wi);
  if (!context.opaque) facing = abs(facing);
  const float mostFacing = cosineOfDifference(facing, within);
  if (mostFacing < -kLightSlack) return 0.0;
  if (infinite) return node.intensity * max(mostFacing, kLeastFacing);
  float leaving = -dot(axis, wi);
  if ((node.link & kLightNodeBothSides) != 0u) leaving = abs(leaving);
  const float emission = cosineOfDifference(leaving, cosThetaO);
  const float mostEmission = cosineOfDifference(emission, within);
  if (mostEmission < cosThetaE - kLightSlack) return 0.0;

  const float likelyFacing = max(mix(mostFacing, max(facing, 0.0), kLightLikely), kLeastFacing);
  const float likelyEmission = max(mix(mostEmission, max(emission, 0.0), kLightLikely), kLeastEmission);
  const float strength = node.intensity * likelyFacing * likelyEmission;
  return clamp(strength / max(squared, kNearest * radius * radius), 1e-35, 1e30);
}

const uint kLightCertain = 0x80000000u;         // a probability of 1
const uint kLightNoContribution = 0xFFFFFFFFu;  // neither child can contribute

// Returns the probability of the first of two children, in units of 2^-31, and the links of both. Each child that can
// contribute gets at least one unit.
uint lightFirstProbability(uint pair, LightSampleContext context, out uvec2 links) {
  float first = 0.0;
  float second = 0.0;
  bool share = false;
  links = uvec2(0u);
  // A loop, so that compilers that inline the body compile it once. Unrolled, it takes 3 to 8 % more time on the H200.
  [[dont_unroll]] for (uint i = 0u; i < 2u; ++i) {
    const LightNode node = LightNodeArray(frame.lightNodes).at[pair + i];
    first = second;
    second = lightImportance(node, context);
    links = uvec2(links.y, node.link);
    share = share || (node.link & kLightNodeShare) != 0u;
  }
  if (second == 0.0) return first == 0.0 ? kLightNoContribution : kLightCertain;
  if (first == 0.0) return 0u;
  precise float probability = first / (first + second);
  const float least = context.opaque ? kLightShare : kLightShareTransmissive;
  if (share) probability = least + (1.0 - 2.0 * least) * probability;
  return uint(clamp(probability * 2147483648.0, 1.0, 2147483520.0));
}

// Returns floor((d · 2^31 + r) / part) for d < part ≤ 2^31 and r < 2^31. The result is exact: 31 bits that are uniform if
// d and r are. It uses reciprocals, because devices divide 64-bit integers slowly. The first quotient is off by at most
// 2^11, the second by 1.
uint lightDigits(uint d, uint r, uint part) {
  const uint64_t n = uint64_t(d) << 31 | uint64_t(r);
  const float inverse = 1.0 / float(part);
  uint q = uint(min((float(d) * 2147483648.0 + float(r)) * inverse, 2147483520.0));
  q += uint(int(floor(float(int64_t(n - uint64_t(q) * uint64_t(part))) * inverse)));
  const int64_t left = int64_t(n - uint64_t(q) * uint64_t(part));
  return left < 0l ? q - 1u : left >= int64_t(part) ? q + 1u : q;
}

// Samples a light by u in [0,1). `bits` are random and independent of u. Returns kNoLight if no light at the reached node
// can contribute.
uint drawLight(LightSampleContext context, float u, uint bits, out float probability) {
  uint link = LightNodeArray(frame.lightNodes).at[0].link;
  uint digits = uint(u * 16777216.0) << 7 | bits & 127u;  // 31 binary digits
  probability = LightNodeArray(frame.lightNodes).at[0].intensity > 0.0 ? 1.0 : 0.0;
  while (kHasLightTree && (link & kLightNodeLeaf) == 0u && probability > 0.0) {
    uvec2 links;
    const uint firstProbability = lightFirstProbability(link & kLightNodeIndex, context, links);
    if (firstProbability == kLightNoContribution) {
      probability = 0.0;
      break;
    }
    const bool first = digits < firstProbability;
    const uint part = first ? firstProbability : kLightCertain - firstProbability;
    probability *= float(part) * (1.0 / 2147483648.0);
    link = first ? links.x : links.y;
    if ((link & kLightNodeLeaf) != 0u) break;
    // Rescale u within its part for the next decision. Bits that u does not have are random.
    bits = hash(bits + 0x9E3779B9u);
    digits = lightDigits(first ? digits : digits - firstProbability, bits >> 1, part);
  }
  return probability > 0.0 ? link & kLightNodeIndex : kNoLight;
}

// Returns the probability with which drawLight reaches this leaf.
float lightLeafProbability(LightSampleContext context, uint leaf) {
  if (leaf == kNoLight) return 0.0;
  float probability = 1.0;
  uint link = LightNodeArray(frame.lightNodes).at[0].link;
  for (uint at = 0u; kHasLightTree && at != leaf && probability > 0.0;) {
    const uint pair = link & kLightNodeIndex;
    uvec2 links;
    const uint firstProbability = lightFirstProbability(pair, context, links);
    const bool first = leaf != pair + 1u && (leaf == pair || (links.y & kLightNodeLeaf) != 0u || leaf < (links.y & kLightNodeIndex));
    const uint part = firstProbability == kLightNoContribution ? 0u : first ? firstProbability : kLightCertain - firstProbability;
    probability *= float(part) * (1.0 / 2147483648.0);
    at = first ? pair : pair + 1u;
    link = first ? links.x : links.y;
  }
  return probability;
}

#endif
