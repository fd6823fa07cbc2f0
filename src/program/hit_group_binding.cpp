// SPDX-License-Identifier: Apache-2.0
#include "program/hit_group_binding.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

namespace quintet::program {
namespace {

bool isBound(const HitGroup& group) {
  return !group.geometry.empty() || !group.material.empty() || !group.primitives.empty();
}

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return !name.empty() && std::find(names.begin(), names.end(), name) != names.end();
}

std::string_view kindName(GeometryKind kind) {
  constexpr std::array<std::string_view, 4> kNames{"triangles", "solids", "csg", "custom"};
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace

bool hasIntersection(const HitGroup& group) {
  return std::ranges::any_of(group.shaders, [](const auto& entry) { return !entry.second.intersection.empty(); });
}

std::size_t hitGroupFor(const Program& program, const GeometryFacts& geometry) {
  const auto first = [&](auto matches) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < program.hitGroups.size(); ++i)
      if (matches(program.hitGroups[i])) return i;
    return {};
  };
  const bool boxes = geometry.procedural();
  const auto fits = [&](const HitGroup& g) { return hasIntersection(g) == boxes; };
  const std::string_view kind = kindName(geometry.kind), opacity = geometry.alpha ? "alpha" : "opaque";
  if (auto i = first([&](const HitGroup& g) { return contains(g.primitives, geometry.name); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return fits(g) && contains(g.material, geometry.material); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return contains(g.geometry, kind); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return boxes && contains(g.geometry, "procedural"); })) return *i;
  if (geometry.thin && !geometry.alpha)
    if (auto i = first([&](const HitGroup& g) { return fits(g) && contains(g.geometry, "thin"); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return fits(g) && contains(g.geometry, opacity); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return !isBound(g) && fits(g); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return !isBound(g); })) return *i;
  return 0;
}

SingleAnyHit requiredSingleAnyHit(const Program& program) {
  const auto isOwn = [](const auto& shaders) {
    return !shaders.second.anyHit.empty() && !isLibraryStage(shaders.second.anyHit);
  };
  const bool own =
      std::ranges::any_of(program.hitGroups, [&](const HitGroup& g) { return std::ranges::any_of(g.shaders, isOwn); });
  if (!own) return SingleAnyHit::tinting;
  return program.anyHitForAll ? SingleAnyHit::all : SingleAnyHit::notOpaque;
}

SceneFacts factsFor(const Program& program, SceneFacts facts) {
  if (!program.anyHitForAll) return facts;
  for (InstanceFacts& instance : facts.instances) instance.forceNoOpaque = !instance.forceOpaque;
  return facts;
}

}  // namespace quintet::program
