// Which hit group serves which geometry: every rank of the precedence, lists of names, and what the parser refuses.
#include "program/link.h"
#include "program_test_support.h"

namespace quintet::program {
namespace {

HitGroup group(const std::string& name, bool boxes) {
  HitGroup g;
  g.name = name;
  g.shaders["radiance"].intersection = boxes ? "box.rint" : "";
  return g;
}

// The name of the group that serves the geometry.
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

// One group of every rank, the weakest first, so that the order in the file cannot help.
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

TEST(HitGroup, TheStrongestBindingWins) {
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

TEST(HitGroup, AlphaBoxesGoByTheirClassWithoutAKind) {
  Program p = everyRank();
  std::erase_if(p.hitGroups, [](const HitGroup& g) { return g.name == "procedural"; });
  EXPECT_EQ(serving(p, boxes(GeometryKind::solids, "wood", "set", true)), "alpha boxes");
  EXPECT_EQ(serving(p, boxes(GeometryKind::solids, "wood")), "any boxes");
}

TEST(HitGroup, ThinWallsAreOpaqueToProgramsWithoutTheClass) {
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

TEST(HitGroup, TheFirstOfEqualsWins) {
  Program p;
  for (const char* name : {"first", "second"}) p.hitGroups.emplace_back(group(name, false)).material = {"glass"};
  EXPECT_EQ(serving(p, triangles("glass")), "first");
}

TEST(HitGroup, WithoutAFittingGroupOneWithoutBindingServes) {
  Program p;
  p.hitGroups.emplace_back(group("glass", false)).material = {"glass"};
  p.hitGroups.emplace_back(group("any", false));
  EXPECT_EQ(serving(p, boxes(GeometryKind::custom, "glass")), "any")
      << "a triangle group does not serve boxes by material";
  p.hitGroups.pop_back();
  EXPECT_EQ(serving(p, triangles("wood")), "glass") << "the last resort is the first group";
}

TEST(HitGroup, EmptyNamesBindNothing) {
  Program p;
  p.hitGroups.emplace_back(group("named", false)).primitives = {"x"};
  p.hitGroups.emplace_back(group("any", false));
  EXPECT_EQ(serving(p, {GeometryKind::triangles, false, "", ""}), "any");
}

TEST(HitGroup, TrianglesAndKindsCanBeListed) {
  Program p;
  p.hitGroups.emplace_back(group("any", true));
  p.hitGroups.emplace_back(group("two", true)).geometry = {"solids", "custom"};
  p.hitGroups.emplace_back(group("mesh", false)).geometry = {"triangles"};
  EXPECT_EQ(serving(p, boxes(GeometryKind::solids)), "two");
  EXPECT_EQ(serving(p, boxes(GeometryKind::custom)), "two");
  EXPECT_EQ(serving(p, boxes(GeometryKind::csg)), "any");
  EXPECT_EQ(serving(p, triangles()), "mesh");
}

const std::string kGroup = std::string(kSmall) + "\n[[hit_group]]\nname = \"g\"\n";  // its keys from line 11 on

TEST(HitGroup, BindingsAreANameOrAListOfNames) {
  const Program p =
      parse(kGroup + "geometry = [\"csg\", \"custom\"]\nmaterial = [\"glass\", \"ice\"]\nprimitives = \"balls\"\n");
  ASSERT_EQ(p.hitGroups.size(), 1u);
  EXPECT_EQ(p.hitGroups[0].geometry, (std::vector<std::string>{"csg", "custom"}));
  EXPECT_EQ(p.hitGroups[0].material, (std::vector<std::string>{"glass", "ice"}));
  EXPECT_EQ(p.hitGroups[0].primitives, std::vector<std::string>{"balls"});
}

TEST(HitGroup, WrongBindingsAreRefused) {
  EXPECT_EQ(errorOf(kGroup + "geometry = \"triangle\"\n"),
            "line 11: 'triangle' is no class of geometry; did you mean 'triangles'?");
  EXPECT_EQ(errorOf(kGroup + "geometry = \"zzzzzzzzzzzzzzz\"\n"),
            "line 11: 'zzzzzzzzzzzzzzz' is no class of geometry; there are triangles, solids, csg, custom, procedural, "
            "opaque, alpha, thin");
  EXPECT_EQ(errorOf(kGroup + "material = 3\n"),
            "line 11: 'material' of [[hit_group]] must be a string or a list of strings");
  EXPECT_EQ(errorOf(kGroup + "material = [\"a\", 3]\n"),
            "line 11: 'material' of [[hit_group]] must be a string or a list of strings");
  EXPECT_EQ(errorOf(kGroup + "primitives = []\n"), "line 11: 'primitives' of [[hit_group]] is an empty list");
  EXPECT_EQ(errorOf(kGroup + "primitives = \"\"\n"), "line 11: 'primitives' of [[hit_group]] has an empty name");
  for (const char* name : {"name", "geometry", "material", "primitives", "record"})
    EXPECT_EQ(errorOf(changed(kSmall, "\"radiance\"", std::string("\"") + name + "\"")),
              std::string("line 6: '") + name + "' cannot be a ray's name: it is a key of [[hit_group]]");
}

}  // namespace
}  // namespace quintet::program
