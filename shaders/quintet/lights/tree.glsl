// Choosing one light of many for a receiver, by a binary tree of bounds: A. Conty Estevez and C. Kulla, "Importance
// Sampling of Many Lights with Adaptive Tree Splitting" (2018), section 5, without the splitting: one light is drawn.
// At each node the children are weighed by a bound of the irradiance that their lights may give. The way to a known
// light is found from its leaf's index alone, by the same arithmetic: so its probability is exactly that of drawing it.
#ifndef QUINTET_LIGHTS_TREE_GLSL
#define QUINTET_LIGHTS_TREE_GLSL

#include "../frame.glsl"
#include "../sampling/hash.glsl"

// Where light is to arrive. The probability of a light depends on all of it: to weigh a light that a BSDF sample has
// met, ask with the receiver that the sample left.
struct LightReceiver {
  vec3 position;
  vec3 normal;  // world, unit, geometric; 0: no surface
  bool opaque;  // light from behind is worth nothing
};

// A receiver without a surface (volumes).
LightReceiver lightReceiver(vec3 position) { return LightReceiver(position, vec3(0.0), false); }

// Cosines below the bounds by less than this may be rounding: no light that can contribute has probability 0.
const float kLightSlack = 1e-3;
// Least cosines that are believed: of the receiver, because a shading normal is not the geometric one, and of the light.
const float kLeastFacing = 0.0625;
const float kLeastEmission = 0.01;
// Between the largest cosines (0) and those towards the centre (1): measured, docs/measurements.md.
const float kLightLikely = 0.75;
// The distance is not taken as less than this part of the radius, squared: neither.
const float kNearest = 0.125;
// Least part of the draws for each side of a kLightNodeShare. In glass narrow lobes find panels themselves, not the sun.
const float kLightShare = 0.15;
const float kLightShareThrough = 0.5;

// cos(max(0, a - b)) of two angles in [0, pi] by their cosines.
float cosineOfDifference(float a, float b) {
  return a >= b ? 1.0 : a * b + sqrt(max(0.0, (1.0 - a * a) * (1.0 - b * b)));
}

vec3 lightAxis(uint bits) {
  const vec2 v = unpackSnorm2x16(bits);
  const float z = 1.0 - abs(v.x) - abs(v.y);
  const float fold = max(-z, 0.0);
  return normalize(vec3(v.x + (v.x >= 0.0 ? -fold : fold), v.y + (v.y >= 0.0 ? -fold : fold), z));
}

// Estimate of the irradiance from the lights of a node; 0 only if none of them can contribute.
float lightImportance(LightNode node, LightReceiver receiver) {
  const bool infinite = (node.link & kLightNodeInfinite) != 0u;
  const vec3 axis = lightAxis(node.axis);
  const vec2 cone = unpackSnorm2x16(node.cone);
  const vec3 d = infinite ? axis : node.center - receiver.position;
  const float squared = dot(d, d);
  const float radius = node.radius + 5e-7 * (abs(receiver.position.x) + abs(receiver.position.y) + abs(receiver.position.z));
  const vec3 wi = d * inversesqrt(max(squared, 1e-37));
  // The lights are seen within this angle of wi: that of the ball, or all directions from inside.
  float within = squared > radius * radius ? sqrt(1.0 - radius * radius / squared) : -1.0;
  if (infinite) within = cone.x;

  // Each cosine towards the centre, then the largest in the ball.
  float facing = receiver.normal == vec3(0.0) ? 1.0 : dot(receiver.normal, wi);
  if (!receiver.opaque) facing = abs(facing);
  const float mostFacing = cosineOfDifference(facing, within);
  if (mostFacing < -kLightSlack) return 0.0;
  if (infinite) return node.intensity * max(mostFacing, kLeastFacing);
  float leaving = -dot(axis, wi);
  if ((node.link & kLightNodeBothSides) != 0u) leaving = abs(leaving);
  const float emission = cosineOfDifference(leaving, cone.x);
  const float mostEmission = cosineOfDifference(emission, within);
  if (mostEmission < cone.y - kLightSlack) return 0.0;

  const float likelyFacing = max(mix(mostFacing, max(facing, 0.0), kLightLikely), kLeastFacing);
  const float likelyEmission = max(mix(mostEmission, max(emission, 0.0), kLightLikely), kLeastEmission);
  const float strength = node.intensity * likelyFacing * likelyEmission;
  return clamp(strength / max(squared, kNearest * radius * radius), 1e-35, 1e30);
}

const uint kLightSure = 0x80000000u;     // a chance of 1
const uint kLightDeadEnd = 0xFFFFFFFFu;  // neither child can contribute

// Chance of the first of two children, in units of 2^-31. At least 1 unit for each that can contribute.
uint lightFirstChance(uint pair, LightReceiver receiver) {
  float first = 0.0;
  float second = 0.0;
  bool share = false;
  for (uint i = 0u; i < 2u; ++i) {  // in a loop: compilers that inline it see it once
    const LightNode node = LightNodeArray(frame.lightNodes).at[pair + i];
    first = second;
    second = lightImportance(node, receiver);
    share = share || (node.link & kLightNodeShare) != 0u;
  }
  if (second == 0.0) return first == 0.0 ? kLightDeadEnd : kLightSure;
  if (first == 0.0) return 0u;
  precise float chance = first / (first + second);
  const float least = receiver.opaque ? kLightShare : kLightShareThrough;
  if (share) chance = least + (1.0 - 2.0 * least) * chance;
  return uint(clamp(chance * 2147483648.0, 1.0, 2147483520.0));
}

// floor((d · 2^31 + r) / part) for d < part ≤ 2^31 and r < 2^31: exact, so 31 digits that are uniform if d and r are. By
// reciprocals, since devices divide 64 bits slowly: the first quotient is off by 2^11 at most, the second by 1.
uint lightDigits(uint d, uint r, uint part) {
  const uint64_t n = uint64_t(d) << 31 | uint64_t(r);
  const float inverse = 1.0 / float(part);
  uint q = uint(min((float(d) * 2147483648.0 + float(r)) * inverse, 2147483520.0));
  q += uint(int(floor(float(int64_t(n - uint64_t(q) * uint64_t(part))) * inverse)));
  const int64_t left = int64_t(n - uint64_t(q) * uint64_t(part));
  return left < 0l ? q - 1u : left >= int64_t(part) ? q + 1u : q;
}

// Draws a light by u in [0,1); `bits`: random, independent of u. kNoLight: the draw came to lights that give nothing.
uint drawLight(LightReceiver receiver, float u, uint bits, out float probability) {
  uint link = LightNodeArray(frame.lightNodes).at[0].link;
  uint digits = uint(u * 16777216.0) << 7 | bits & 127u;  // 31 binary digits
  probability = LightNodeArray(frame.lightNodes).at[0].intensity > 0.0 ? 1.0 : 0.0;
  while ((link & kLightNodeLeaf) == 0u && probability > 0.0) {
    const uint pair = link & kLightNodeIndex;
    const uint chance = lightFirstChance(pair, receiver);
    if (chance == kLightDeadEnd) {
      probability = 0.0;
      break;
    }
    const bool first = digits < chance;
    const uint part = first ? chance : kLightSure - chance;
    probability *= float(part) * (1.0 / 2147483648.0);
    // What u is within its part serves further; digits that it does not have are random.
    bits = hash(bits + 0x9E3779B9u);
    digits = lightDigits(first ? digits : digits - chance, bits >> 1, part);
    link = LightNodeArray(frame.lightNodes).at[first ? pair : pair + 1u].link;
  }
  return probability > 0.0 ? link & kLightNodeIndex : kNoLight;
}

// The probability with which drawLight comes to this leaf.
float lightLeafProbability(LightReceiver receiver, uint leaf) {
  if (leaf == kNoLight) return 0.0;
  float probability = 1.0;
  for (uint at = 0u; at != leaf && probability > 0.0;) {
    const uint pair = LightNodeArray(frame.lightNodes).at[at].link & kLightNodeIndex;
    const uint second = LightNodeArray(frame.lightNodes).at[pair + 1u].link;
    const bool first = leaf != pair + 1u && (leaf == pair || (second & kLightNodeLeaf) != 0u || leaf < (second & kLightNodeIndex));
    const uint chance = lightFirstChance(pair, receiver);
    const uint part = chance == kLightDeadEnd ? 0u : first ? chance : kLightSure - chance;
    probability *= float(part) * (1.0 / 2147483648.0);
    at = first ? pair : pair + 1u;
  }
  return probability;
}

#endif
