// SPDX-License-Identifier: Apache-2.0
#version 460
#extension GL_EXT_ray_tracing : require
#include "payloads.glsl"

layout(location = 2) rayPayloadInEXT Distance free;

void main() { free.t = gl_HitTEXT; }
