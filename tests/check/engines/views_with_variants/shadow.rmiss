// SPDX-License-Identifier: Apache-2.0
layout(location = 1) rayPayloadInEXT float lit;

void main() { lit = 1.0; }
