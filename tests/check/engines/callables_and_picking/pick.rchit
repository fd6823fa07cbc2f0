// SPDX-License-Identifier: Apache-2.0
layout(location = 0) rayPayloadInEXT uint picked;

void main() { picked = gl_InstanceCustomIndexEXT; }
