// SPDX-License-Identifier: Apache-2.0
layout(location = 2) rayPayloadInEXT float visible;
void main() { visible = 1.0; }
