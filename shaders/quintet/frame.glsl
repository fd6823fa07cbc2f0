// SPDX-License-Identifier: Apache-2.0
// Access to the frame and the scene's arrays from any stage. `launch` is the push-constant block of every program and
// of every compute shader that includes this file.
#ifndef QUINTET_FRAME_GLSL
#define QUINTET_FRAME_GLSL

#include "shared/bindings.h"
#include "shared/frame.h"

layout(push_constant, scalar) uniform LaunchBlock { Launch launch; };
layout(set = 0, binding = kBindingTextures) uniform sampler2D textures[];

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer FrameReference { Frame value; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer InstanceArray { InstanceData at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer GeometryArray { GeometryData at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer MaterialArray { MaterialData at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer PrimitiveArray { PrimitiveData at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer CsgNodeArray { CsgNodeData at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer CsgTreeArray { CsgTreeData at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer BoxArray { BoxData at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LightArray { LightData at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LightNodeArray { LightNode at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer AliasArray { AliasEntry at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer UintArray { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer PrimitiveIndexArray { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer FloatArray { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Vec2Array { vec2 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Vec3Array { vec3 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Vec4Array { vec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Uvec3Array { uvec3 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer OutputArray { vec4 at[]; };

// Accesses members of the frame without a copy: frame.lightCount, frame.camera.halfSize, …
#define frame FrameReference(launch.frameAddress).value

const float kPi = 3.14159265358979323846;
const float kInfinity = 3.402823466e38;  // the largest float: a ray without limit

// Rec. 709 luminance.
float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }
float maxComponent(vec3 c) { return max(c.x, max(c.y, c.z)); }

#endif
