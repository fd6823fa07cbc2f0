// SPDX-License-Identifier: Apache-2.0
// The 32-bit words of the members of a shared struct, in C++ and GLSL. `GPU_FIELDS(Type, members…)` is the list for
// both. C++ binds it to all members in order, so that a missing or extra member does not compile. GLSL reads each
// member by name: a wrong name does not compile, and a wrong order makes the test fail.
#ifndef QUINTET_TESTS_GPU_SHARED_FIELDS_H
#define QUINTET_TESTS_GPU_SHARED_FIELDS_H

#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include "quintet/shared/deform.h"
#include "quintet/shared/explain.h"
#include "quintet/shared/film.h"
#include "quintet/shared/heat.h"
#include "quintet/shared/instrument.h"
#include "quintet/shared/log.h"

namespace quintet::test {

using Words = std::vector<std::uint32_t>;

// The words of a member, in memory order.
inline void appendWords(Words& words, std::uint32_t value) { words.push_back(value); }
inline void appendWords(Words& words, float value) { words.push_back(std::bit_cast<std::uint32_t>(value)); }
inline void appendWords(Words& words, std::uint64_t value) {
  words.push_back(static_cast<std::uint32_t>(value));
  words.push_back(static_cast<std::uint32_t>(value >> 32));
}
template <glm::length_t n, class T, glm::qualifier q>
void appendWords(Words& words, const glm::vec<n, T, q>& value) {
  for (glm::length_t i = 0; i < n; ++i) appendWords(words, value[i]);
}
template <class T, std::size_t n>
void appendWords(Words& words, const T (&values)[n]) {
  for (const T& value : values) appendWords(words, value);
}

// The same in GLSL, in both directions. glslOf generates the functions for a struct from its list.
inline constexpr const char* kGlslWords = R"(
uint words[256];
uint wordCount = 0u;
void put(uint v) { words[wordCount++] = v; }
void put(float v) { put(floatBitsToUint(v)); }
void put(uint64_t v) { put(uint(v)); put(uint(v >> 32)); }
void put(uvec2 v) { put(v.x); put(v.y); }
void put(uvec4 v) { put(v.x); put(v.y); put(v.z); put(v.w); }
void put(vec2 v) { put(v.x); put(v.y); }
void put(vec3 v) { put(v.xy); put(v.z); }
void put(vec4 v) { put(v.xyz); put(v.w); }
void put(vec4 v[3]) { for (int i = 0; i < 3; ++i) put(v[i]); }
void put(uint v[4]) { for (int i = 0; i < 4; ++i) put(v[i]); }
void put(uint v[2]) { for (int i = 0; i < 2; ++i) put(v[i]); }
void put(uint v[8]) { for (int i = 0; i < 8; ++i) put(v[i]); }
void put(uint v[16]) { for (int i = 0; i < 16; ++i) put(v[i]); }
void put(uint v[64]) { for (int i = 0; i < 64; ++i) put(v[i]); }
void put(uint64_t v[2]) { for (int i = 0; i < 2; ++i) put(v[i]); }
void put(uint64_t v[kMaxOutputs]) { for (int i = 0; i < int(kMaxOutputs); ++i) put(v[i]); }
uint nextWord() { return words[wordCount++]; }
void take(out uint v) { v = nextWord(); }
void take(out float v) { v = uintBitsToFloat(nextWord()); }
void take(out uint64_t v) { const uint low = nextWord(); v = uint64_t(low) | uint64_t(nextWord()) << 32; }
void take(out uvec2 v) { take(v.x); take(v.y); }
void take(out uvec4 v) { take(v.x); take(v.y); take(v.z); take(v.w); }
void take(out vec2 v) { take(v.x); take(v.y); }
void take(out vec3 v) { take(v.x); take(v.y); take(v.z); }
void take(out vec4 v) { take(v.x); take(v.y); take(v.z); take(v.w); }
void take(out vec4 v[3]) { for (int i = 0; i < 3; ++i) take(v[i]); }
void take(out uint v[4]) { for (int i = 0; i < 4; ++i) take(v[i]); }
void take(out uint v[2]) { for (int i = 0; i < 2; ++i) take(v[i]); }
void take(out uint v[8]) { for (int i = 0; i < 8; ++i) take(v[i]); }
void take(out uint v[16]) { for (int i = 0; i < 16; ++i) take(v[i]); }
void take(out uint v[64]) { for (int i = 0; i < 64; ++i) take(v[i]); }
void take(out uint64_t v[2]) { for (int i = 0; i < 2; ++i) take(v[i]); }
void take(out uint64_t v[kMaxOutputs]) { for (int i = 0; i < int(kMaxOutputs); ++i) take(v[i]); }
)";

// Functions put and take for a struct with these members ("a, b, c").
inline std::string glslOf(const std::string& type, const std::string& members) {
  std::string put, take;
  for (std::size_t at = 0; at < members.size();) {
    const std::size_t comma = std::min(members.find(',', at), members.size());
    const std::string name = members.substr(at, comma - at);
    put += " put(v." + name + ");";
    take += " take(v." + name + ");";
    at = comma + 1;
  }
  return "void put(" + type + " v) {" + put + " }\nvoid take(out " + type + " v) {" + take + " }\n";
}

template <class T>
struct Fields;

#define GPU_FIELDS(Type, ...)                                                                \
  inline void appendWords(Words& words, const shared::Type& object) {                        \
    const auto& [__VA_ARGS__] = object;                                                      \
    const auto append = [&](const auto&... members) { (appendWords(words, members), ...); }; \
    append(__VA_ARGS__);                                                                     \
  }                                                                                          \
  template <>                                                                                \
  struct Fields<shared::Type> {                                                              \
    static constexpr const char* kName = #Type;                                              \
    static std::string glsl() { return glslOf(#Type, #__VA_ARGS__); }                        \
  }

GPU_FIELDS(TextureData, rowU, rowV, index, uvSet);
GPU_FIELDS(MaterialData, baseColor, emissive, metallic, roughness, normalScale, alphaCutoff, ior, transmission,
           specular, specularColor, clearcoat, clearcoatRoughness, clearcoatNormalScale, absorption, flags, sheenColor,
           sheenRoughness, diffuseTransmissionColor, diffuseTransmission, anisotropy, anisotropyDirection, iridescence,
           iridescenceIor, iridescenceThicknessMinimum, iridescenceThicknessMaximum, dispersion, scatteringAlbedo,
           scatterAnisotropy, dielectricPriority, baseColorTexture, metallicRoughnessTexture, normalTexture,
           emissiveTexture, transmissionTexture, specularTexture, specularColorTexture, clearcoatTexture,
           clearcoatRoughnessTexture, clearcoatNormalTexture, sheenColorTexture, sheenRoughnessTexture,
           diffuseTransmissionTexture, diffuseTransmissionColorTexture, anisotropyTexture, iridescenceTexture,
           iridescenceThicknessTexture);
GPU_FIELDS(AliasEntry, keep, alias, probability);
GPU_FIELDS(LightData, intensity, type, position, instance, direction, geometry, cosInner, cosOuter, primitive, leaf);
GPU_FIELDS(LightNode, center, radius, intensity, axis, cone, link);
GPU_FIELDS(EnvironmentData, table, balancedTable, scale, texture, width, height, cosRotation, sinRotation);
GPU_FIELDS(InstanceData, worldFromObject, objectFromWorld, firstGeometry, firstLightSlot, flags, customIndex);
GPU_FIELDS(GeometryData, positions, triangles, normals, tangents, uvs, colors, primitiveMap, boxes, primitives, nodes,
           trees, material, triangleCount, kind, padding);
GPU_FIELDS(PrimitiveData, primitiveFromObject, objectFromPrimitive, type, parameter, material, padding);
GPU_FIELDS(CsgNodeData, operation, operand);
GPU_FIELDS(CsgTreeData, firstNode, nodeCount);
GPU_FIELDS(BoxData, min, max);
GPU_FIELDS(CameraData, worldFromCamera, halfSize, apertureRadius, focusDistance, orthographic, padding);
GPU_FIELDS(RayRecord, origin, tmax, direction, kind);
GPU_FIELDS(RayKinds, camera, cameraHits, continuation, continuationHits, shadow, shadowHits);
GPU_FIELDS(Frame, instances, geometries, materials, lights, lightTable, lightSlots, albedoTables, statistics,
           rayRecords, instrument, outputs, previousOutputs, environment, camera, width, height, filmOffset, filmWidth,
           filmHeight, lightCount, environmentLight, seed, flags, rayRecordCapacity, instanceCount, frameCount,
           plannedSamples, lightNodes, previousInstances, previousPositions, log, heat, cameraMedia, previousCamera);
GPU_FIELDS(InstrumentReport, kind, stage, line, depth, pixel, distance, index, origin, direction, interval);
GPU_FIELDS(RecursionGuard, cutCount);
GPU_FIELDS(InstrumentPixel, depth, anyHits, instance, geometry, primitive, flags, stage, line);
GPU_FIELDS(Instrument, reportCount, traceCount, anyHitCount, mostAnyHits, deepest, pixelCount, missCount, callableCount,
           outputCount, depthLimit, rays, recordPairs, badRecords);
GPU_FIELDS(HeatPixel, rays, bounces, depth, deepest, anyHits, intersections);
GPU_FIELDS(LogHeader, capacity, used, dropped, state, firstPixel, endPixel);
GPU_FIELDS(LogRecord, kind, wordCount, pixel, sampleIndex);
GPU_FIELDS(ExplainRay, stage, line, flags, mask, recordOffset, recordStride, missIndex, origin, tmin, direction, tmax);
GPU_FIELDS(ExplainRayEnd, traced);
GPU_FIELDS(ExplainCall, stage, line, index);
GPU_FIELDS(ExplainStage, stage);
GPU_FIELDS(ExplainHit, stage, instance, geometry, primitive, material, geometryKind, hitKind, t, barycentric, uv,
           geometricNormal, shadingNormal, runsProgram);
GPU_FIELDS(ExplainBox, stage, instance, geometry, primitive, tmin, tmax);
GPU_FIELDS(ExplainStageEnd, result);
GPU_FIELDS(ExplainReport, t, hitKind, accepted);
GPU_FIELDS(ExplainStore, stage, line, slot, mode, pixel, value);
GPU_FIELDS(ExplainCamera, film, lens);
GPU_FIELDS(ExplainSurface, position, geometricNormal, shadingNormal, uv, material, frontFace);
GPU_FIELDS(ExplainShading, normal, emission, baseColor, metallic, alpha, transmission, ior, clearcoat, sheenColor,
           sheenAlpha, diffuseTransmission, anisotropy, iridescence, iridescenceThickness, dispersion, unlit);
GPU_FIELDS(ExplainLobe, lobe, probability);
GPU_FIELDS(ExplainLightChoice, light, type, instance, geometry, primitive, probability);
GPU_FIELDS(ExplainLightSample, delta, direction, distance, radiance, pdf, bsdf, bsdfPdf, misWeight, throughput);
GPU_FIELDS(ExplainLightRoulette, survival, u);
GPU_FIELDS(ExplainVisibility, transmittance);
GPU_FIELDS(ExplainBsdfSample, useful, delta, transmitted, straight, direction, pdf, weight);
GPU_FIELDS(ExplainRoulette, survival, u, throughput);
GPU_FIELDS(ExplainEmission, source, radiance, throughput, bsdfPdf, lightPdf, misWeight);
GPU_FIELDS(ExplainContribution, source, scatterings, value, unclamped);
GPU_FIELDS(ExplainPathEnd, reason);
GPU_FIELDS(FilmBatch, tiles, count, width, height, inverseSamples);
GPU_FIELDS(FilmAdd, total, squares, values, batch);
GPU_FIELDS(FilmMean, total, mean, count, inverseSamples);
GPU_FIELDS(FilmCoverage, total, values, batch);
GPU_FIELDS(NotFinite, count, first);
GPU_FIELDS(FilmFrame, total, batch, marks, count, mark);
GPU_FIELDS(FilmCheck, values, result, count, sums, mark, padding);
GPU_FIELDS(FixedSum, word);
GPU_FIELDS(CoverageSlot, id, samples);
GPU_FIELDS(FilmTile, x, y, drawn, batch);
GPU_FIELDS(DeformTarget, positions, normals, tangents);
GPU_FIELDS(DeformSkinSet, joints, weights);
GPU_FIELDS(DeformMatrix, rows, flags);
GPU_FIELDS(DeformGeometry, positions, normals, tangents, deformedPositions, deformedNormals, deformedTangents, targets,
           skinSets, triangles, firstCorners, corners, weights, matrices, vertexCount, targetCount, skinSetCount, flags,
           triangleCount, padding);
GPU_FIELDS(DeformPass, geometry);
GPU_FIELDS(TreeCostNode, low, high, cost);
GPU_FIELDS(TreeCostGeometry, positions, triangles, first, padding);
GPU_FIELDS(TreeCostList, order, geometries, triangleCount, geometryCount, depth, padding);
GPU_FIELDS(TreeCostPass, leaves, roots, list, leafCount, padding);
GPU_FIELDS(Launch, frameAddress, parameterAddress, offset, firstSample, sampleCount, tiles);

#undef GPU_FIELDS

}  // namespace quintet::test
#endif
