// SPDX-License-Identifier: Apache-2.0
// Ends the renaming of names_begin.glsl, and replaces built-ins that depend on the driver, the launch strip or the order of
// primitives: from here on gl_PrimitiveID is the index in the scene, and so on.
#ifndef QUINTET_GSN_OPEN
#undef Address
#undef AliasArray
#undef AliasEntry
#undef BoxArray
#undef BoxData
#undef CameraData
#undef CsgNodeArray
#undef CsgNodeData
#undef CsgTreeArray
#undef CsgTreeData
#undef EnvironmentData
#undef ExplainBox
#undef ExplainBsdfSample
#undef ExplainCall
#undef ExplainCamera
#undef ExplainContribution
#undef ExplainEmission
#undef ExplainHit
#undef ExplainLightChoice
#undef ExplainLightSample
#undef ExplainLobe
#undef ExplainPathEnd
#undef ExplainRay
#undef ExplainRayEnd
#undef ExplainReport
#undef ExplainRoulette
#undef ExplainShading
#undef ExplainStage
#undef ExplainStageEnd
#undef ExplainStore
#undef ExplainSurface
#undef ExplainVisibility
#undef FilmTile
#undef FloatArray
#undef Frame
#undef FrameReference
#undef GeometryArray
#undef GeometryData
#undef HeatPixel
#undef InstanceArray
#undef InstanceData
#undef Launch
#undef LaunchBlock
#undef LightArray
#undef LightData
#undef LogHeader
#undef LogRecord
#undef MaterialArray
#undef MaterialData
#undef OutputArray
#undef Parameters
#undef ParametersReference
#undef PrimitiveArray
#undef PrimitiveData
#undef PrimitiveIndexArray
#undef RayKinds
#undef RayRecord
#undef TextureData
#undef TileArray
#undef UintArray
#undef Uvec3Array
#undef Vec2Array
#undef Vec3Array
#undef Vec4Array
#undef evenBits
#undef frame
#undef kInfinity
#undef kPi
#undef launch
#undef launchActive
#undef launchPixel
#undef luminance
#undef maxComponent
#undef parameters
#undef textures
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
