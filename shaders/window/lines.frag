// SPDX-License-Identifier: Apache-2.0
// The coverage of a line with round ends, and the depth test of its center line against the surfaces.
#version 460

layout(push_constant) uniform Constants {
  vec2 scale;
  vec2 depthOrigin;  // of the depth image in the target, pixels
  float depthScale;  // pixels of the target per pixel of the depth image
  float relativeBias, bias;
  float hiddenOpacity;
  float dash;
  uint outline;
} constants;

layout(set = 0, binding = 0) uniform sampler2D surfaceDepth;  // reversed: larger is nearer

layout(location = 0) in vec2 position;
layout(location = 1) flat in vec4 lineEnds;
layout(location = 2) flat in vec4 lineDepthsAndOpacities;
layout(location = 3) flat in vec4 lineColor;
layout(location = 4) flat in float lineRadius;

layout(location = 0) out vec4 color;

const float kFarthest = -3.402823466e38;  // the least float

// The farthest surface at the pixel and beside it, so that lines on an inclined surface are visible. Outside of the
// depth image there is no surface.
float farthestSurface(vec2 point) {
  const ivec2 last = textureSize(surfaceDepth, 0) - 1;
  const ivec2 pixel = ivec2(floor((point - constants.depthOrigin) / constants.depthScale));
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThan(pixel, last))) return kFarthest;
  float depth = texelFetch(surfaceDepth, pixel, 0).r;
  depth = min(depth, texelFetch(surfaceDepth, clamp(pixel + ivec2(1, 0), ivec2(0), last), 0).r);
  depth = min(depth, texelFetch(surfaceDepth, clamp(pixel - ivec2(1, 0), ivec2(0), last), 0).r);
  depth = min(depth, texelFetch(surfaceDepth, clamp(pixel + ivec2(0, 1), ivec2(0), last), 0).r);
  depth = min(depth, texelFetch(surfaceDepth, clamp(pixel - ivec2(0, 1), ivec2(0), last), 0).r);
  return depth;
}

// Coverage of the dashes at a distance from the start of the line, pixels.
float dashes(float distance) {
  const float fraction = fract(distance / (2.0 * constants.dash));
  return clamp(0.5 + constants.dash * (0.5 - abs(2.0 * fraction - 1.0)), 0.0, 1.0);
}

void main() {
  const vec2 a = lineEnds.xy, b = lineEnds.zw;
  const float squaredLength = dot(b - a, b - a);
  const float t = squaredLength > 0.0 ? clamp(dot(position - a, b - a) / squaredLength, 0.0, 1.0) : 0.0;
  const vec2 center = mix(a, b, t);
  float opacity = clamp(lineRadius - distance(position, center) + 0.5, 0.0, 1.0);
  if (opacity <= 0.0) discard;
  opacity *= mix(lineDepthsAndOpacities.z, lineDepthsAndOpacities.w, t);
  const float depth = mix(lineDepthsAndOpacities.x, lineDepthsAndOpacities.y, t);
  const float surface = farthestSurface(center);
  if (depth < surface - constants.relativeBias * abs(surface) - constants.bias) {
    opacity *= constants.hiddenOpacity;
    if (constants.dash > 0.0 && squaredLength > 0.0) opacity *= dashes(t * sqrt(squaredLength));
  }
  color = vec4(lineColor.rgb, lineColor.a * opacity);
}
