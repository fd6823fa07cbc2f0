// SPDX-License-Identifier: Apache-2.0
layout(location = 0) rayPayloadInEXT vec4 color;

void main() { color = vec4(0, 0, 0, 1); }
