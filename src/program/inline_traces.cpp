// SPDX-License-Identifier: Apache-2.0
#include "program/inline_traces.h"

#include <algorithm>
#include <string_view>

#include "program/hit_group_binding.h"

namespace quintet::program {
namespace {

using Defines = std::vector<std::pair<std::string, std::string>>;

bool defines(const Defines& all, std::string_view name) {
  return std::ranges::any_of(all, [&](const auto& define) { return define.first == name; });
}

HitShaders shadersOf(const HitGroup& group, const char* ray) {
  const auto found = group.shaders.find(ray);
  return found != group.shaders.end() ? found->second : HitShaders{};
}

bool hasMissShaders(const Program& program) {
  return std::ranges::all_of(program.rays, [](const RayType& ray) {
    if (ray.name == "radiance") return ray.miss == "<quintet/stages/radiance.rmiss>";
    return ray.name != "shadow" || ray.miss == "<quintet/stages/shadow.rmiss>";
  });
}

// Any-hit shaders do not run for opaque triangles.
bool servesOpaqueTriangles(const HitGroup& group) {
  return hasIntersection(group) || shadersOf(group, "radiance").closestHit == "<quintet/stages/surface.rchit>";
}

// True if the any-hit shaders of the program test the triangles with alpha as the ray queries do.
bool testsAlpha(const Program& program) {
  const bool selects = std::ranges::any_of(program.hitGroups, [](const HitGroup& group) {
    return !hasIntersection(group) && (!group.material.empty() || !group.primitives.empty());
  });
  if (selects) return false;
  GeometryFacts leaf;
  leaf.alpha = true;
  const HitGroup& group = program.hitGroups[hitGroupFor(program, leaf)];
  const bool hasShadows = std::ranges::any_of(program.rays, [](const RayType& ray) { return ray.name == "shadow"; });
  return shadersOf(group, "radiance").anyHit == "<quintet/stages/alpha.rahit>" &&
         (!hasShadows || shadersOf(group, "shadow").anyHit == "<quintet/stages/transmittance.rahit>");
}

}  // namespace

std::vector<std::pair<std::string, std::string>> withTraces(const Program& program, Defines all,
                                                            Instrumentation instrumentation) {
  const bool isOpaque = defines(all, "QUINTET_NO_SEEDS");
  const bool isInline = instrumentation == Instrumentation::none && !program.anyHitForAll && hasMissShaders(program) &&
                        !program.hitGroups.empty() && std::ranges::all_of(program.hitGroups, servesOpaqueTriangles) &&
                        (isOpaque || testsAlpha(program));
  if (!isInline) std::erase_if(all, [](const auto& define) { return define.first == kInlineTraces; });
  return all;
}

}  // namespace quintet::program
