// SPDX-License-Identifier: Apache-2.0
// Ends the renaming of quintet/names_begin.glsl, and replaces built-ins that depend on the driver, the launch strip or the order of
// primitives: from here on gl_PrimitiveID is the index in the scene, and so on.
#ifndef QUINTET_GSN_OPEN
#include <quintet/names_end.glsl>
#endif

#define gl_LaunchIDEXT gsnLaunchID()
#define gl_LaunchSizeEXT gsnLaunchSize()
#ifdef QUINTET_GSN_HIT
#define gl_PrimitiveID gsnPrimitive()
#define gl_InstanceID gsnInstance()
#define gl_InstanceCustomIndexEXT gsnCustomIndex()
#define gl_GeometryIndexEXT gsnGeometryIndex()
#define gl_ObjectToWorldEXT gsnObjectToWorld()
#define gl_WorldToObjectEXT gsnWorldToObject()
#define gl_ObjectToWorld3x4EXT gsnObjectToWorld3x4()
#define gl_WorldToObject3x4EXT gsnWorldToObject3x4()
#ifndef QUINTET_GSN_INTERSECTION
#define gl_HitKindEXT gsnHitKind()
#endif
#endif
#define sampler2D gsnImage
