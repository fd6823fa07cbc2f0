// SPDX-License-Identifier: Apache-2.0
// Which hit group serves which geometry: every rank of the precedence, and lists of names.
#include "program/hit_group_binding.h"

#include <gtest/gtest.h>

namespace quintet::program {
namespace {

HitGroup group(const std::string& name, bool boxes) {
  HitGroup g;
  g.name = name;
  g.shaders["radiance"].intersection = boxes ? "box.rint" : "";
  return g;
}

// Returns the name of the group that serves the geometry.
std::string serving(const Program& program, const GeometryFacts& geometry) {
  return program.hitGroups.at(hitGroupFor(program, geometry)).name;
}

GeometryFacts triangles(const std::string& material = {}, bool alpha = false) {
  return {GeometryKind::triangles, alpha, "mesh", material};
}
GeometryFacts boxes(GeometryKind kind, const std::string& material = {}, const std::string& name = "set",
                    bool alpha = false) {
  return {kind, alpha, name, material};
}

// Returns a program with a group of every rank, the weakest first, so that the order in the file does not decide.
Program everyRank() {
  Program p;
  const auto add = [&](const std::string& name, bool box, auto bind) {
    bind(p.hitGroups.emplace_back(group(name, box)));
  };
  add("any boxes", true, [](HitGroup&) {});
  add("any triangles", false, [](HitGroup&) {});
  add("alpha triangles", false, [](HitGroup& g) { g.geometry = {"alpha"}; });
  add("alpha boxes", true, [](HitGroup& g) { g.geometry = {"alpha"}; });
  add("procedural", true, [](HitGroup& g) { g.geometry = {"procedural"}; });
  add("csg", true, [](HitGroup& g) { g.geometry = {"csg"}; });
  add("glass triangles", false, [](HitGroup& g) { g.material = {"glass", "ice"}; });
  add("glass boxes", true, [](HitGroup& g) { g.material = {"ice", "glass"}; });
  add("balls", true, [](HitGroup& g) { g.primitives = {"balls", "more balls"}; });
  return p;
}

TEST(HitGroupBinding, PrefersTheStrongestBinding) {
  const Program p = everyRank();
  constexpr GeometryKind csg = GeometryKind::csg, solids = GeometryKind::solids, custom = GeometryKind::custom;
  EXPECT_EQ(serving(p, boxes(csg, "glass", "balls")), "balls");
  EXPECT_EQ(serving(p, boxes(csg, "glass", "more balls")), "balls");
  EXPECT_EQ(serving(p, boxes(csg, "glass")), "glass boxes");
  EXPECT_EQ(serving(p, triangles("glass")), "glass triangles");
  EXPECT_EQ(serving(p, triangles("ice", true)), "glass triangles");
  EXPECT_EQ(serving(p, boxes(csg, "wood")), "csg");
  EXPECT_EQ(serving(p, boxes(solids, "wood")), "procedural");
  EXPECT_EQ(serving(p, boxes(custom, "wood", "set", true)), "procedural");
  EXPECT_EQ(serving(p, triangles("wood", true)), "alpha triangles");
  EXPECT_EQ(serving(p, triangles("wood")), "any triangles");
}

TEST(HitGroupBinding, BindsAlphaBoxesByClassIfNoGroupHasTheirKind) {
  Program p = everyRank();
  std::erase_if(p.hitGroups, [](const HitGroup& g) { return g.name == "procedural"; });
  EXPECT_EQ(serving(p, boxes(GeometryKind::solids, "wood", "set", true)), "alpha boxes");
  EXPECT_EQ(serving(p, boxes(GeometryKind::solids, "wood")), "any boxes");
}

TEST(HitGroupBinding, TreatsThinWallsAsOpaqueWithoutAGroupOfTheClass) {
  Program p;
  p.hitGroups.emplace_back(group("alpha", false)).geometry = {"alpha"};
  p.hitGroups.emplace_back(group("opaque", false)).geometry = {"opaque"};
  GeometryFacts pane = triangles();
  pane.thin = true;
  EXPECT_EQ(serving(p, pane), "opaque");
  p.hitGroups.emplace_back(group("thin", false)).geometry = {"thin"};
  EXPECT_EQ(serving(p, pane), "thin");
  EXPECT_EQ(serving(p, triangles()), "opaque");
  pane.alpha = true;
  EXPECT_EQ(serving(p, pane), "alpha");
}

TEST(HitGroupBinding, PrefersTheFirstOfEqualGroups) {
  Program p;
  for (const char* name : {"first", "second"}) p.hitGroups.emplace_back(group(name, false)).material = {"glass"};
  EXPECT_EQ(serving(p, triangles("glass")), "first");
}

TEST(HitGroupBinding, FallsBackToAGroupWithoutBinding) {
  Program p;
  p.hitGroups.emplace_back(group("glass", false)).material = {"glass"};
  p.hitGroups.emplace_back(group("any", false));
  EXPECT_EQ(serving(p, boxes(GeometryKind::custom, "glass")), "any")
      << "a triangle group does not serve boxes by material";
  p.hitGroups.pop_back();
  EXPECT_EQ(serving(p, triangles("wood")), "glass") << "the last resort is the first group";
}

TEST(HitGroupBinding, IgnoresEmptyNames) {
  Program p;
  p.hitGroups.emplace_back(group("named", false)).primitives = {"x"};
  p.hitGroups.emplace_back(group("any", false));
  EXPECT_EQ(serving(p, {GeometryKind::triangles, false, "", ""}), "any");
}

TEST(HitGroupBinding, AcceptsListsOfKinds) {
  Program p;
  p.hitGroups.emplace_back(group("any", true));
  p.hitGroups.emplace_back(group("two", true)).geometry = {"solids", "custom"};
  p.hitGroups.emplace_back(group("mesh", false)).geometry = {"triangles"};
  EXPECT_EQ(serving(p, boxes(GeometryKind::solids)), "two");
  EXPECT_EQ(serving(p, boxes(GeometryKind::custom)), "two");
  EXPECT_EQ(serving(p, boxes(GeometryKind::csg)), "any");
  EXPECT_EQ(serving(p, triangles()), "mesh");
}

TEST(HitGroupBinding, OwnAnyHitShadersRunOncePerIntersection) {
  Program p;
  HitGroup& all = p.hitGroups.emplace_back(group("all", false));
  EXPECT_EQ(requiredSingleAnyHit(p), SingleAnyHit::tinting);
  all.shaders["shadow"].anyHit = "<quintet/stages/alpha_shadow.rahit>";
  p.anyHitForAll = true;
  EXPECT_EQ(requiredSingleAnyHit(p), SingleAnyHit::tinting);
  all.shaders["radiance"].anyHit = "layers.rahit";
  EXPECT_EQ(requiredSingleAnyHit(p), SingleAnyHit::all);
  p.anyHitForAll = false;
  EXPECT_EQ(requiredSingleAnyHit(p), SingleAnyHit::notOpaque);
}

TEST(HitGroupBinding, OpensInstancesToAnyHitShaders) {
  SceneFacts facts;
  facts.instances.resize(2);
  facts.instances[1].forceOpaque = true;
  Program p;
  EXPECT_FALSE(factsFor(p, facts).instances[0].forceNoOpaque);
  p.anyHitForAll = true;
  EXPECT_TRUE(factsFor(p, facts).instances[0].forceNoOpaque);
  EXPECT_FALSE(factsFor(p, facts).instances[1].forceNoOpaque);
}

}  // namespace
}  // namespace quintet::program
