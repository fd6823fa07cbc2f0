// SPDX-License-Identifier: Apache-2.0
layout(location = 0) rayPayloadInEXT vec4 transmittance;

void main() { transmittance.w = 1.0; }
