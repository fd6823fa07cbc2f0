// SPDX-License-Identifier: Apache-2.0
// Vertices of gpu::DrawList: pixels from the top left corner.
#version 460

layout(push_constant) uniform Constants {
  vec2 scale;  // 2 / size of the target in pixels
} constants;

layout(location = 0) in vec2 position;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 color;

layout(location = 0) out vec2 fragmentUv;
layout(location = 1) out vec4 fragmentColor;

void main() {
  fragmentUv = uv;
  fragmentColor = color;
  gl_Position = vec4(position * constants.scale - 1.0, 0.0, 1.0);
}
