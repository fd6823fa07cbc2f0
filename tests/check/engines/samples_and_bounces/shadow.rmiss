// SPDX-License-Identifier: Apache-2.0
layout(location = 1) rayPayloadInEXT bool isShadowed;

void main() { isShadowed = false; }
