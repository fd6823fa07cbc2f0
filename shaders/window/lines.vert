// SPDX-License-Identifier: Apache-2.0
// Lines of gpu::LineList: a rectangle around each, which the fragment shader cuts to its round shape.
#version 460

layout(push_constant) uniform Constants {
  vec2 scale;  // 2 / size of the target in pixels
  vec2 depthOrigin;
  float depthScale;
  float relativeBias, bias;
  float hiddenOpacity;
  float dash;
  uint outline;
} constants;

layout(location = 0) in vec4 ends;               // pixels: a, b
layout(location = 1) in vec4 depthsAndOpacities;
layout(location = 2) in vec4 color;
layout(location = 3) in vec4 outlineColor;
layout(location = 4) in vec2 widthAndOutline;

layout(location = 0) out vec2 position;  // pixels
layout(location = 1) flat out vec4 lineEnds;
layout(location = 2) flat out vec4 lineDepthsAndOpacities;
layout(location = 3) flat out vec4 lineColor;
layout(location = 4) flat out float lineRadius;

void main() {
  const vec2 a = ends.xy, b = ends.zw;
  lineEnds = ends;
  lineDepthsAndOpacities = depthsAndOpacities;
  lineColor = constants.outline != 0u ? outlineColor : color;
  lineRadius = 0.5 * widthAndOutline.x + (constants.outline != 0u ? widthAndOutline.y : 0.0);
  const float margin = lineRadius + 1.0;
  const float size = length(b - a);
  const vec2 along = size > 1e-6 ? (b - a) / size : vec2(1.0, 0.0);
  const vec2 across = vec2(-along.y, along.x);
  // Two triangles: corners 0 1 2, 2 1 3.
  const int corner = gl_VertexIndex < 3 ? gl_VertexIndex : gl_VertexIndex == 3 ? 2 : gl_VertexIndex == 4 ? 1 : 3;
  const bool atEnd = (corner & 1) != 0;
  const float side = (corner & 2) != 0 ? 1.0 : -1.0;
  position = (atEnd ? b + margin * along : a - margin * along) + side * margin * across;
  gl_Position = vec4(position * constants.scale - 1.0, 0.0, 1.0);
}
