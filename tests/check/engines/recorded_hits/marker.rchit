// SPDX-License-Identifier: Apache-2.0
layout(location = 0) rayPayloadInEXT uint marker;

void main() {
  marker = 1u;
}
