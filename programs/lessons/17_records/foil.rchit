// SPDX-License-Identifier: Apache-2.0
#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/record.glsl>
#include "payloads.glsl"

layout(location = 0) rayPayloadInEXT Radiance radiance;

void main() { radiance = Radiance(0.6 * record.tint, 0.0); }
