// SPDX-License-Identifier: Apache-2.0
struct Payload {
  vec3 color;
};
