// SPDX-License-Identifier: Apache-2.0
// Known driver defects (docs/design/quirks.md). A test of the oracle that detects a defect passes its entry to
// Checks::done(): the test passes while the driver is wrong as documented, and fails once this or a newer version is
// correct, so that the workaround can be removed. On every other driver, and in versions outside of first and fixed, the
// same values must be correct.
#ifndef QUINTET_TESTS_ORACLE_KNOWN_QUIRKS_H
#define QUINTET_TESTS_ORACLE_KNOWN_QUIRKS_H

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "gpu/vulkan.h"

namespace quintet::oracle {

inline constexpr std::uint32_t kMesa25 = VK_MAKE_API_VERSION(0, 25, 0, 7), kMesa26 = VK_MAKE_API_VERSION(0, 26, 1, 6);

struct KnownQuirk {
  std::string_view id;
  std::string_view text;
  // Some machines with this driver do not have the defect, so correct values are no failure.
  bool sporadic = false;
  VkDriverId driver = VK_DRIVER_ID_MESA_LLVMPIPE;
  std::uint32_t version = kMesa25;  // where the defect was observed
  std::uint32_t first = 0;          // versions before it do not have the defect; 0: unknown
  // From this version on, the driver is correct; 0: no such version is known. Versions between `version` and this one
  // may or may not have the defect.
  std::uint32_t fixed = 0;
};

inline constexpr KnownQuirk kStaleBuiltIns{"stale-built-ins",
                                           "built-ins that are read after a nested trace belong to the inner hit"};
inline constexpr KnownQuirk kVertexLeaks{"vertex-leaks", "rays exactly at a shared vertex miss"};
inline constexpr KnownQuirk kEdgesHitTwice{
    .id = "edges-hit-twice",
    .text = "a ray on a shared edge hits both triangles, also with NO_DUPLICATE_ANY_HIT",
    .fixed = kMesa26};
inline constexpr KnownQuirk kLooseAttributes{
    "loose-attributes",
    "hit attributes do not belong to the committed hit: candidates that are rejected later overwrite them"};
inline constexpr KnownQuirk kTmaxNotLowered{
    "tmax-not-lowered", "gl_RayTmaxEXT is not lowered after an accepted report of the same invocation"};
inline constexpr KnownQuirk kSharedArrays{
    "shared-arrays", "dynamically indexed local arrays of an intersection shader and its any-hit shader share storage"};
inline constexpr KnownQuirk kSharedAnyHit{
    "shared-any-hit", "hit groups that share an intersection stage use the first group's any-hit shader"};
inline constexpr KnownQuirk kFirstVertexTwice{
    .id = "first-vertex-twice", .text = "firstVertex of a build range is applied twice", .fixed = kMesa26};
inline constexpr KnownQuirk kInactiveTakesOthers{"inactive-takes-others",
                                                 "valid primitives disappear next to inactive ones (NaN)"};
inline constexpr KnownQuirk kNoCompaction{"no-compaction", "compaction returns the full size"};
inline constexpr KnownQuirk kEmptyPipelineCache{"empty-pipeline-cache", "VkPipelineCache contains no pipelines"};
inline constexpr KnownQuirk kLibrariesCrash{
    .id = "libraries-crash",
    .text = "a pipeline whose stages all come from libraries and that has push constants crashes",
    .fixed = kMesa26};
inline constexpr KnownQuirk kHiddenInstancesCrash{
    .id = "hidden-instances-crash",
    .text = "traces crash if only some instances of a structure are inactive or have mask 0",
    .version = kMesa26,
    .first = VK_MAKE_API_VERSION(0, 25, 1, 0)};
inline constexpr KnownQuirk kIntegerMasks{
    "integer-masks", "LLVM 15 miscompiles integer code for some CPUs with AVX-512", /*sporadic=*/true};
inline constexpr KnownQuirk kKeepsOrder{
    .id = "keeps-order",
    .text = "the builder does not sort primitives but halves the input order (the left half has ceil(n/2))",
    .fixed = kMesa26};
inline constexpr KnownQuirk kAllQuirks[] = {
    kStaleBuiltIns,      kVertexLeaks,    kEdgesHitTwice,    kLooseAttributes,     kTmaxNotLowered,
    kSharedArrays,       kSharedAnyHit,   kFirstVertexTwice, kInactiveTakesOthers, kNoCompaction,
    kEmptyPipelineCache, kLibrariesCrash, kIntegerMasks,     kKeepsOrder,          kHiddenInstancesCrash};

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
