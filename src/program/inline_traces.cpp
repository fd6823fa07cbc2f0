// SPDX-License-Identifier: Apache-2.0
#include "program/inline_traces.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "program/hit_group_binding.h"
#include "program/load.h"

namespace quintet::program {
namespace {

using Defines = std::vector<std::pair<std::string, std::string>>;

constexpr std::string_view kAlpha = "<quintet/stages/alpha.rahit>";
constexpr std::string_view kTransmittance = "<quintet/stages/transmittance.rahit>";

bool isOneOf(std::string_view file, std::initializer_list<std::string_view> files) {
  return std::ranges::find(files, file) != files.end();
}

HitShaders shadersOf(const HitGroup& group, const char* ray) {
  const auto found = group.shaders.find(ray);
  return found != group.shaders.end() ? found->second : HitShaders{};
}

bool hasLibraryRays(const Program& program) {
  return program.misses.empty() && program.callables.empty() &&
         std::ranges::all_of(program.rays, [](const RayType& ray) {
           return (ray.name == "radiance" && ray.miss == "<quintet/stages/radiance.rmiss>") ||
                  (ray.name == "shadow" && ray.miss == "<quintet/stages/shadow.rmiss>");
         });
}

// The any-hit shaders of the library accept all candidates without alpha, also of instances that are forced not to be opaque.
bool hasLibraryHits(const HitGroup& group) {
  const HitShaders radiance = shadersOf(group, "radiance"), shadow = shadersOf(group, "shadow");
  return hasIntersection(group) ||
         (radiance.closestHit == "<quintet/stages/surface.rchit>" && isOneOf(radiance.anyHit, {"", kAlpha}) &&
          isOneOf(shadow.anyHit, {"", kTransmittance, "<quintet/stages/alpha_shadow.rahit>"}));
}

// True if the program tests the triangles with alpha as the ray queries do.
bool testsAlpha(const Program& program) {
  const bool selects = std::ranges::any_of(program.hitGroups, [](const HitGroup& group) {
    return !hasIntersection(group) && (!group.material.empty() || !group.primitives.empty());
  });
  if (selects) return false;
  GeometryFacts leaf;
  leaf.alpha = true;
  const HitGroup& group = program.hitGroups[hitGroupFor(program, leaf)];
  const bool hasShadows = std::ranges::any_of(program.rays, [](const RayType& ray) { return ray.name == "shadow"; });
  return shadersOf(group, "radiance").anyHit == kAlpha &&
         (!hasShadows || shadersOf(group, "shadow").anyHit == kTransmittance);
}

bool canQuery(const Program& program, bool alpha) {
  return isBuiltIn(program) && !program.anyHitForAll && hasLibraryRays(program) &&
         std::ranges::all_of(program.hitGroups, hasLibraryHits) &&
         !std::ranges::all_of(program.hitGroups, hasIntersection) && (!alpha || testsAlpha(program));
}

}  // namespace

std::vector<std::pair<std::string, std::string>> withoutInlineTraces(Defines defines) {
  std::erase_if(defines, [](const auto& define) { return define.first == kInlineTraces; });
  return defines;
}

std::vector<std::pair<std::string, std::string>> definesOfStages(const Program& program, Defines defines,
                                                                 Instrumentation instrumentation) {
  const bool alpha =
      std::ranges::none_of(defines, [](const auto& define) { return define.first == "QUINTET_NO_SEEDS"; });
  const bool queries = instrumentation == Instrumentation::none && canQuery(program, alpha);
  return queries ? defines : withoutInlineTraces(std::move(defines));
}

}  // namespace quintet::program
