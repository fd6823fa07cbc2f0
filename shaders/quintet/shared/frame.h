// SPDX-License-Identifier: Apache-2.0
// The data of a frame that programs read: camera, film, and the addresses of the scene's arrays. There is one Frame per
// image; its address is the first push constant.
#ifndef QUINTET_SHARED_FRAME_H
#define QUINTET_SHARED_FRAME_H

#include "lights.h"
#include "material.h"
#include "primitive.h"
#include "types.h"

QT_SHARED_BEGIN

// InstanceData::flags
QT_CONSTANT kInstanceMirrored = 1u;  // negative determinant: reverses the winding
QT_CONSTANT kInstanceOpaque = 2u;    // forced opaque: no any-hit shader runs
// Several instances in one acceleration structure (render/scene/merged_instances.h). firstGeometry and firstLightSlot are
// the low and the high word of the address of uvec3[]: gl_PrimitiveID → instance, geometry and primitive in the scene.
QT_CONSTANT kInstanceMerged = 4u;

// One per TLAS instance, indexed by gl_InstanceCustomIndexEXT.
struct InstanceData {
  vec4 worldFromObject[3];  // rows of the affine matrix
  vec4 objectFromWorld[3];
  uint firstGeometry;       // GeometryData of geometry g: firstGeometry + g
  uint firstLightSlot;      // light slot of geometry g: firstLightSlot + g (Frame::lightSlots)
  uint flags;               // kInstance…
  uint customIndex;         // set by the user: scene::Instance::customIndex
};
QT_SHARED_SIZE(InstanceData, 112);

// One geometry of a mesh: triangles, or boxes of procedural primitives. Addresses of absent attributes are 0.
struct GeometryData {
  Address positions;     // vec3[]
  Address triangles;     // uvec3[], in the scene's order
  Address normals;       // vec3[]
  Address tangents;      // vec4[]
  Address uvs[2];        // vec2[]
  Address colors;        // vec4[], linear
  Address primitiveMap;  // uint[]: gl_PrimitiveID → index in triangles, or boxes; 0: identity
  Address boxes;         // BoxData[], kinds other than triangles, in the scene's order; not padded
  Address primitives;    // PrimitiveData[]; solids: box i holds primitives[i]
  Address nodes;         // CsgNodeData[]
  Address trees;         // CsgTreeData[]; csg: box i holds trees[i]
  uint material;         // of triangles and custom boxes; solids have materials of their own
  uint triangleCount;    // number of triangles or boxes
  uint kind;             // kGeometry…
  uint padding;
};
QT_SHARED_SIZE(GeometryData, 112);

// Pinhole, thin lens or orthographic; see quintet/camera.glsl.
struct CameraData {
  vec4 worldFromCamera[3];  // rows; looks along -z, y up
  vec2 halfSize;            // perspective: half extent of the image plane at distance 1; orthographic: meters
  float apertureRadius;     // meters; 0: pinhole
  float focusDistance;      // meters
  uint orthographic;
  uint padding;
};
QT_SHARED_SIZE(CameraData, 72);

// Frame::flags
QT_CONSTANT kFrameTransparent = 1u;  // camera rays that miss the scene give 0 with alpha 0

// Frame::plannedSamples: the random numbers of different pixels are independent; the error is then not blue noise.
QT_CONSTANT kIndependentPixels = 0xFFFFFFFFu;

QT_CONSTANT kMaxOutputs = 32u;
// Samples of a batch: every pixel's samples [k · kBatchSamples, (k+1) · kBatchSamples).
QT_CONSTANT kBatchSamples = 4u;
// RayRecord::kind
QT_CONSTANT kRecordEnd = 0u;      // no further ray of this pixel
QT_CONSTANT kRecordClosest = 1u;
QT_CONSTANT kRecordShadow = 2u;

// A ray that a program traced (QUINTET_RECORD_RAYS). The program `replay` traces it again.
struct RayRecord {
  vec3 origin;
  float tmax;
  vec3 direction;
  uint kind;
};
QT_SHARED_SIZE(RayRecord, 32);

// Counts before the records: all rays by kind, including rays that were not recorded for lack of space.
struct RayKinds {
  uint camera;             // the first ray of each pixel
  uint cameraHits;
  uint continuation;       // other closest-hit rays
  uint continuationHits;
  uint shadow;
  uint shadowHits;         // occluded
};
QT_SHARED_SIZE(RayKinds, 24);

// Number of solids that a path can be in at the same time (quintet/media.glsl).
QT_CONSTANT kMaxMedia = 4u;

QT_CONSTANT kNoLight = 0xFFFFFFFFu;

// Ids that pathtracer counts (pixel = "coverage"): this + index. The bit pattern is a normal float, which no device
// alters.
QT_CONSTANT kCoverageId = 0x3F800000u;

struct Frame {
  Address instances;    // InstanceData[]
  Address geometries;   // GeometryData[]
  Address materials;    // MaterialData[]
  Address lights;       // LightData[lightCount]
  Address lightTable;   // AliasEntry[lightCount]
  Address lightSlots;   // uint[]: first LightData of an instance's geometry (+ primitive), or kNoLight
  Address albedoTables; // quintet/bsdf/albedo.glsl
  Address statistics;   // uvec2[filmWidth · filmHeight]: rays traced, samples dropped; 0: do not count
  Address rayRecords;   // RayKinds, then RayRecord[filmWidth · filmHeight · rayRecordCapacity], for benchmarks; else 0
  Address instrument;   // Instrument and its pixels (shared/instrument.h); 0: not instrumented
  // vec4[]: sums of this batch, or as the output's rule defines (program::OutputPixel); 0: an optional output that was not
  // requested. The pixels of the film, row by row from the top; if the launch covers tiles, kTileSize² pixels for each tile.
  Address outputs[kMaxOutputs];
  Address previousOutputs[kMaxOutputs];  // vec4[…]: of the previous frame, if the program accumulates; 0: none
  EnvironmentData environment;
  CameraData camera;
  uint width;           // pixels of the whole image
  uint height;
  uvec2 filmOffset;     // pixel of the image at which the film begins (a region of the image)
  uint filmWidth;       // pixels
  uint filmHeight;
  uint lightCount;
  uint environmentLight;  // index of the environment in `lights`, or kNoLight
  uint seed;
  uint flags;           // kFrame…
  uint rayRecordCapacity;  // records per pixel
  uint instanceCount;
  uint frameCount;      // frames of this run, if the program accumulates; 0: unlimited
  uint plannedSamples;  // for the sampler: total per pixel, 0 if unknown, or kIndependentPixels
  Address lightNodes;   // LightNode[]: the tree for sampling lights
  Address previousInstances;  // InstanceData[] of the previous frame of an animation; 0: instances do not move
  // Address[] per geometry: vec3[] of its vertices in the previous frame, or 0; 0: no geometry is deformed, or the program
  // has no motion to store (quintet/motion.glsl).
  Address previousPositions;
  Address log;          // LogHeader and its words (shared/log.h); 0: no log
  Address heat;         // HeatPixel[filmWidth · filmHeight] (shared/heat.h); 0: no heat maps
  // Solids around the camera: 1 + index of the material, from the inside to the outside; 0: no further one.
  uvec4 cameraMedia;
  CameraData previousCamera;  // of the previous frame of an animation
};
QT_SHARED_SIZE(Frame, 8 * 10 + 2 * 8 * 32 + 40 + 72 + 56 + 48 + 16 + 72);

// Adaptive sampling divides the image into squares of kTileSize pixels, starting at the film's first pixel. Each has
// two cells, the pixels with even and with odd x + y. Each cell has its own number of samples.
QT_CONSTANT kTileSize = 32u;
// A batch of a tile. A list can contain several batches of a tile, which then run at the same time.
struct FilmTile {
  uint x;            // position of the first pixel, relative to the film
  uint y;
  uint drawn[2];     // 1: the cell is sampled in this batch
  uint batch;        // index of the batch
};
QT_SHARED_SIZE(FilmTile, 20);

// Push constants of every ray tracing program. No member has the name of a macro (`frame`, `parameters`): glslang would
// expand it again in an argument of a macro.
struct Launch {
  Address frameAddress;      // Frame
  Address parameterAddress;  // the program's parameter block (generated struct Parameters)
  uvec2 offset;              // pixel of launch invocation (0,0)
  uint firstSample;  // index of the first sample of this launch; index of the frame, if the program accumulates
  uint sampleCount;  // samples to take per pixel in this launch
  Address tiles;     // FilmTile[]: the launch covers these, kTileSize rows for each; 0: a rectangle of pixels
};
QT_SHARED_SIZE(Launch, 40);

QT_SHARED_END

#endif
