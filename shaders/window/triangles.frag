// SPDX-License-Identifier: Apache-2.0
// The color of a vertex, multiplied by the texture. Both are sRGB-encoded, with straight alpha.
#version 460

layout(set = 0, binding = 0) uniform sampler2D image;

layout(location = 0) in vec2 fragmentUv;
layout(location = 1) in vec4 fragmentColor;

layout(location = 0) out vec4 color;

void main() {
  color = fragmentColor * texture(image, fragmentUv);
}
