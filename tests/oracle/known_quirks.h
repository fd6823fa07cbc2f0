// What drivers are known to get wrong (docs/design/quirks.md). A test of the oracle that meets such a
// defect names its entry: it passes while the driver is wrong as documented, and fails when a driver of
// that version or newer has become right, so that the workaround goes. On every other driver the same
// values have to be right.
#ifndef QUINTET_TESTS_ORACLE_KNOWN_QUIRKS_H
#define QUINTET_TESTS_ORACLE_KNOWN_QUIRKS_H

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "gpu/vulkan.h"

namespace quintet::oracle {

struct KnownQuirk {
  std::string_view id;
  std::string_view text;
  // Some machines with this driver do not show it: right values are no news.
  bool sporadic = false;
  VkDriverId driver = VK_DRIVER_ID_MESA_LLVMPIPE;
  std::uint32_t version = VK_MAKE_API_VERSION(0, 25, 0, 7);  // where it was seen
};

inline constexpr KnownQuirk kStaleBuiltIns{"stale-built-ins",
                                           "built-ins read after a nested trace are those of the inner hit"};
inline constexpr KnownQuirk kVertexLeaks{"vertex-leaks", "rays aimed exactly at a shared vertex fall through"};
inline constexpr KnownQuirk kEdgesMeetTwice{
    "edges-meet-twice", "a ray on a shared edge meets both triangles, also with NO_DUPLICATE_ANY_HIT"};
inline constexpr KnownQuirk kLooseAttributes{
    "loose-attributes", "hit attributes are not tied to the committed hit: a candidate rejected later overwrites them"};
inline constexpr KnownQuirk kTmaxNotLowered{
    "tmax-not-lowered", "gl_RayTmaxEXT is not lowered after an accepted report of the same invocation"};
inline constexpr KnownQuirk kSharedArrays{
    "shared-arrays", "dynamically indexed local arrays of an intersection shader and its any-hit shader share storage"};
inline constexpr KnownQuirk kSharedAnyHit{
    "shared-any-hit", "hit groups that share an intersection stage use the first group's any-hit shader"};
inline constexpr KnownQuirk kFirstVertexTwice{"first-vertex-twice", "firstVertex of a build range is applied twice"};
inline constexpr KnownQuirk kInactiveTakesOthers{"inactive-takes-others",
                                                 "inactive primitives (NaN) make valid ones vanish"};
inline constexpr KnownQuirk kNoCompaction{"no-compaction", "compaction returns the full size"};
inline constexpr KnownQuirk kEmptyPipelineCache{"empty-pipeline-cache", "VkPipelineCache holds nothing"};
inline constexpr KnownQuirk kLibrariesCrash{
    "libraries-crash", "a pipeline whose stages all come from libraries and that has push constants crashes"};
inline constexpr KnownQuirk kIntegerMasks{
    "integer-masks", "LLVM 15 miscompiles integer code for some CPUs with AVX-512", /*sporadic=*/true};
inline constexpr KnownQuirk kKeepsOrder{
    "keeps-order", "the builder halves the input order (the left half has ceil(n/2)), however bad it is"};
inline constexpr KnownQuirk kAllQuirks[] = {kStaleBuiltIns,       kVertexLeaks,  kEdgesMeetTwice,     kLooseAttributes,
                                            kTmaxNotLowered,      kSharedArrays, kSharedAnyHit,       kFirstVertexTwice,
                                            kInactiveTakesOthers, kNoCompaction, kEmptyPipelineCache, kLibrariesCrash,
                                            kIntegerMasks,        kKeepsOrder};

struct Driver {
  VkDriverId id = VK_DRIVER_ID_MAX_ENUM;
  std::uint32_t version = 0;
};
Driver testDriver();  // of the device that the tests run on

enum class Verdict { pass, knownQuirk, fail, mended };

// `wrong`: values that are wrong in the way that `quirk` (null: none) describes.
Verdict judge(const Driver& driver, const KnownQuirk* quirk, std::size_t wrong);

}  // namespace quintet::oracle
#endif
