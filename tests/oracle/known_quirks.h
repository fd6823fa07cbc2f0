// SPDX-License-Identifier: Apache-2.0
// Known driver defects (docs/design/quirks.md). A test of the oracle that detects a defect passes its entry to
// Checks::done(): the test passes while the driver is wrong as documented, and fails once this or a newer version is
// correct, so that the workaround can be removed. On every other driver the same values must be correct.
#ifndef QUINTET_TESTS_ORACLE_KNOWN_QUIRKS_H
#define QUINTET_TESTS_ORACLE_KNOWN_QUIRKS_H

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "gpu/vulkan.h"

namespace quintet::oracle {

struct KnownQuirk {
  std::string_view id;
  std::string_view text;
  // Some machines with this driver do not have the defect, so correct values are no failure.
  bool sporadic = false;
  VkDriverId driver = VK_DRIVER_ID_MESA_LLVMPIPE;
  std::uint32_t version = VK_MAKE_API_VERSION(0, 25, 0, 7);  // where the defect was observed
};

inline constexpr KnownQuirk kStaleBuiltIns{"stale-built-ins",
                                           "built-ins that are read after a nested trace belong to the inner hit"};
inline constexpr KnownQuirk kVertexLeaks{"vertex-leaks", "rays exactly at a shared vertex miss"};
inline constexpr KnownQuirk kEdgesHitTwice{
    "edges-hit-twice", "a ray on a shared edge hits both triangles, also with NO_DUPLICATE_ANY_HIT"};
inline constexpr KnownQuirk kLooseAttributes{
    "loose-attributes",
    "hit attributes do not belong to the committed hit: candidates that are rejected later overwrite them"};
inline constexpr KnownQuirk kTmaxNotLowered{
    "tmax-not-lowered", "gl_RayTmaxEXT is not lowered after an accepted report of the same invocation"};
inline constexpr KnownQuirk kSharedArrays{
    "shared-arrays", "dynamically indexed local arrays of an intersection shader and its any-hit shader share storage"};
inline constexpr KnownQuirk kSharedAnyHit{
    "shared-any-hit", "hit groups that share an intersection stage use the first group's any-hit shader"};
inline constexpr KnownQuirk kFirstVertexTwice{"first-vertex-twice", "firstVertex of a build range is applied twice"};
inline constexpr KnownQuirk kInactiveTakesOthers{"inactive-takes-others",
                                                 "valid primitives disappear next to inactive ones (NaN)"};
inline constexpr KnownQuirk kNoCompaction{"no-compaction", "compaction returns the full size"};
inline constexpr KnownQuirk kEmptyPipelineCache{"empty-pipeline-cache", "VkPipelineCache contains no pipelines"};
inline constexpr KnownQuirk kLibrariesCrash{
    "libraries-crash", "a pipeline whose stages all come from libraries and that has push constants crashes"};
inline constexpr KnownQuirk kIntegerMasks{
    "integer-masks", "LLVM 15 miscompiles integer code for some CPUs with AVX-512", /*sporadic=*/true};
inline constexpr KnownQuirk kKeepsOrder{
    "keeps-order", "the builder does not sort primitives but halves the input order (the left half has ceil(n/2))"};
inline constexpr KnownQuirk kAllQuirks[] = {kStaleBuiltIns,       kVertexLeaks,  kEdgesHitTwice,      kLooseAttributes,
                                            kTmaxNotLowered,      kSharedArrays, kSharedAnyHit,       kFirstVertexTwice,
                                            kInactiveTakesOthers, kNoCompaction, kEmptyPipelineCache, kLibrariesCrash,
                                            kIntegerMasks,        kKeepsOrder};

struct Driver {
  VkDriverId id = VK_DRIVER_ID_MAX_ENUM;
  std::uint32_t version = 0;
};
Driver testDriver();  // driver of the tested device

enum class Verdict { pass, knownQuirk, fail, fixed };

// `wrong` is the number of values that are wrong as `quirk` describes; a null `quirk` means none.
Verdict judge(const Driver& driver, const KnownQuirk* quirk, std::size_t wrong);

}  // namespace quintet::oracle
#endif
