// SPDX-License-Identifier: Apache-2.0
// Q201 to Q203, Q401, Q402, Q501 to Q506, Q509, Q601 to Q605, Q608, Q801, Q802; results of the check.
#include "check_test_support.h"

namespace quintet::check {
namespace {

using testing::HasSubstr;
using testing::Not;

// Edits the trace of the ray generation shader.
std::string traceWith(const std::string& from, const std::string& to, const program::SceneFacts* scene = nullptr) {
  return checkEdited(cleanFiles(), "main.rgen", from, to, scene);
}

std::string tomlWith(const Files& files, const std::string& from, const std::string& to,
                     const program::SceneFacts* scene = nullptr) {
  return checkEdited(files, "program.toml", from, to, scene);
}

const program::GeometryFacts kStone{program::GeometryKind::triangles, false, "rock", "stone"};
const program::GeometryFacts kLeaf{program::GeometryKind::triangles, true, "tree", "leaf"};
const program::GeometryFacts kBalls{program::GeometryKind::custom, false, "balls", "glass"};

TEST(CheckHitAttributes, Q201ReportsADifferentType) {
  const Files files = edited(boxFiles(), "box.rchit", "hit.normal;", "vec3(hit.normal, 0.0);");
  EXPECT_TRUE(
      reportsOnly(checkEdited(files, "box.rchit", "struct Hit { vec3 normal; }", "struct Hit { vec2 normal; }"),
                  "Q201 box.rchit:8:21 ",
                  {"'hit'", "'box.rint' of hit group 'boxes', ray type 'primary'", "member 0 'normal': vec3 vs vec2"}));
}

TEST(CheckHitAttributes, Q202ReportsTypesOtherThanVec2ForTriangles) {
  EXPECT_TRUE(reportsOnly(checkEdited(cleanFiles(), "cut.rahit", "hitAttributeEXT vec2", "hitAttributeEXT vec3"),
                          "Q202 cut.rahit:7:22 ", {"'attribs'", "vec3", "hit group 'surface', ray type 'primary'"}));
}

TEST(CheckHitAttributes, Q203ReportsLargeAttributes) {
  Files files = boxFiles();
  for (const char* file : {"box.rint", "box.rchit"})
    files[file] = changed(files[file], "vec3 normal;", "vec3 normal; mat2x3 frame;");
  files["box.rint"] = changed(files["box.rint"], "hit.normal =", "hit.frame = mat2x3(1.0); hit.normal =");
  EXPECT_TRUE(reports(textOf(checkFiles(files)), "Q203 box.rint:7:21 ",
                      {"'hit'", "struct Hit { vec3 normal; mat2x3 frame; }", "36 bytes", "Vulkan allows 32"}));
  DeviceLimits limits;
  limits.name = "a device";
  limits.maxHitAttributeBytes = 36;
  EXPECT_EQ(textOf(checkFiles(files, nullptr, limits)), "");
}

TEST(CheckRecursion, DerivesDepthAndStackFromTheLongestChain) {
  EXPECT_EQ(checkFiles(cleanFiles()).recursionDepth, 2u);
  EXPECT_EQ(checkFiles(boxFiles()).recursionDepth, 2u);
  EXPECT_EQ(checkFiles(cleanFiles()).stackBytes, 16u + (8u + 4u) + 8u);  // ray generation, closest-hit, any-hit
}

// If the shadow ray runs closest-hit shaders, these trace shadow rays again.
constexpr const char* kShadowFlags =
    "gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_shadow";

TEST(CheckRecursion, Q401ReportsACycleWithoutABound) {
  const Files cycle =
      edited(cleanFiles(), "surface.rchit", kShadowFlags, "gl_RayFlagsTerminateOnFirstHitEXT, 0xFFu, kRay_primary");
  EXPECT_TRUE(reports(textOf(checkFiles(cycle)), "Q401 surface.rchit:13:3 ", {"closest-hit shader 'surface.rchit'"}));
  const Files bounded = edited(cycle, "program.toml", "ray_generation", "max_recursion = 5\nray_generation");
  EXPECT_THAT(textOf(checkFiles(bounded)), Not(HasSubstr("Q40")));
  EXPECT_EQ(checkFiles(bounded).recursionDepth, 5u);
}

TEST(CheckRecursion, Q402ReportsDepthBeyondTheDeclaredBoundOrTheDevice) {
  const std::string chain = "2 deep (main.rgen:10 -> surface.rchit:13 -> lit.rmiss)";
  EXPECT_TRUE(reportsOnly(tomlWith(cleanFiles(), "ray_generation", "max_recursion = 1\nray_generation"),
                          "Q402 surface.rchit:13:3 ", {chain, "declares 1"}));
  DeviceLimits limits;
  limits.name = "a device";
  limits.maxRecursion = 1;
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(cleanFiles(), nullptr, limits)), "Q402 surface.rchit:13:3 ",
                          {chain, "a device allows 1"}));
}

// Checks callable shaders c0 to c3. Shader i calls the index in calls[i], or none for '.'.
std::string callChain(const std::string& calls) {
  Files files = callFiles();
  files["program.toml"] =
      changed(files["program.toml"], "\"tint.rcall\"", "\"c0.rcall\", \"c1.rcall\", \"c2.rcall\", \"c3.rcall\"");
  for (std::size_t i = 0; i < 4; ++i) {
    const bool last = calls[i] == '.';
    files["c" + std::to_string(i) + ".rcall"] =
        kHead +
        std::string(
            "layout(location = 0) callableDataInEXT vec4 data;\nlayout(location = 1) callableDataEXT vec4 next;\n") +
        "void main() {\n  next = data;\n" + (last ? "" : std::string("  executeCallableEXT(") + calls[i] + "u, 1);\n") +
        "  data += next;\n}\n";
  }
  std::string text = textOf(checkFiles(files)), result;
  for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
    if (!text.substr(at).starts_with("Q801") && !text.substr(at).starts_with("Q104"))
      result += text.substr(at, text.find('\n', at) + 1 - at);
  return result;
}

TEST(CheckRecursion, LimitsCallsToTwoLevels) {
  EXPECT_EQ(callChain("1..."), "");
  EXPECT_TRUE(reportsOnly(callChain("12.."), "Q402 main.rgen:12:3 ", {"3 deep", "'c0.rcall' (callable index 0)"}));
  EXPECT_TRUE(reportsOnly(callChain("10.."), "Q401 c1.rcall:10:3 ", {"cycle", "'c0.rcall' (callable index 0)"}));
}

TEST(CheckArguments, Q501ReportsAnOffsetOutOfRange) {
  EXPECT_TRUE(reports(traceWith("0xFFu, kRay_primary", "0xFFu, 2u"), "Q501 main.rgen:10:3 ",
                      {"offset of this trace is 2", "2 records"}));
  const program::SceneFacts scene = sceneWith({kStone, kStone});
  EXPECT_TRUE(reports(traceWith("0xFFu, kRay_primary", "0xFFu, 2u", &scene), "Q501 main.rgen:10:3 ",
                      {"instance 'thing' of scene.glb", "record 4", "4 records"}));
}

TEST(CheckArguments, Q501ReportsAWrongStride) {
  const std::string stride = ", kRayTypeCount, kMiss_primary, ";
  EXPECT_TRUE(
      reports(traceWith(stride, ", 1u, kMiss_primary, "), "Q501 main.rgen:10:3 ", {"stride of this trace is 1"}));
  const program::SceneFacts one = sceneWith({kLeaf}), two = sceneWith({kStone, kLeaf});
  EXPECT_EQ(traceWith(stride, ", 1u, kMiss_primary, ", &one), "");
  EXPECT_TRUE(reports(traceWith(stride, ", 3u, kMiss_primary, ", &two), "Q501 main.rgen:10:3 ",
                      {"geometry 1 of instance 'thing'", "record 3 instead of 2"}));
  EXPECT_TRUE(reports(traceWith(stride, ", 5u, kMiss_primary, ", &two), "Q501 main.rgen:10:3 ",
                      {"record 5 instead of 2", "4 records"}));
  EXPECT_EQ(traceWith(stride, ", 0u, kMiss_primary, "), "");  // all geometries use the records of the first one
}

TEST(CheckArguments, Q502ReportsAMissIndexOutOfRange) {
  EXPECT_TRUE(reports(traceWith("kMiss_primary, vec3", "2u, vec3"), "Q502 main.rgen:10:3 ",
                      {"miss index of this trace is 2", "2 miss shaders (index 0 to 1)"}));
}

TEST(CheckArguments, Q503ReportsMoreThanFourBits) {
  EXPECT_TRUE(reports(traceWith(", kRayTypeCount, kMiss_primary, ", ", 16u, kMiss_primary, "), "Q503 main.rgen:10:3 ",
                      {"stride of this trace is 16", "15"}));
  EXPECT_TRUE(
      reports(traceWith("0xFFu, kRay_primary", "0xFFu, 18u"), "Q503 main.rgen:10:3 ", {"offset of this trace is 18"}));
}

TEST(CheckArguments, Q504ReportsMoreThanSixteenBits) {
  EXPECT_TRUE(reports(traceWith("kMiss_primary, vec3", "65536u, vec3"), "Q504 main.rgen:10:3 ",
                      {"miss index of this trace is 65536", "65535", "would use 0"}));
}

TEST(CheckArguments, Q505ReportsMoreThanEightBits) {
  EXPECT_TRUE(
      reportsOnly(traceWith("0xFFu, kRay_primary", "0x100u, kRay_primary"), "Q505 main.rgen:10:3 ", {"0x100", "0x00"}));
}

TEST(CheckArguments, Q506ReportsAShadowRayWithTheRadianceMissShader) {
  Files files = cleanFiles();  // one payload type for all, so that only the index is wrong
  for (auto& [name, text] : files)
    if (name != "program.toml")
      text = changed(text, "struct Shadow { uint lit; };", "struct Shadow { vec3 color; float t; };");
  for (const char* file : {"lit.rmiss", "surface.rchit"}) {
    for (std::size_t at; (at = files[file].find(".lit")) != std::string::npos;) files[file].replace(at, 4, ".t");
    for (std::size_t at; (at = files[file].find("0u;")) != std::string::npos;) files[file].replace(at, 3, "0.0;");
    for (std::size_t at; (at = files[file].find("1u;")) != std::string::npos && at > 400;)
      files[file].replace(at, 3, "1.0;");
  }
  files["surface.rchit"] = changed(files["surface.rchit"], "!= 0u", "!= 0.0");
  ASSERT_EQ(textOf(checkFiles(files)), "");
  EXPECT_TRUE(reports(checkEdited(files, "surface.rchit", "kMiss_shadow,\n", "kMiss_primary,\n"),
                      "Q506 surface.rchit:13:3 ", {"'sky.rmiss' (index 0)", "'lit.rmiss' (index 1)"}));
}

TEST(CheckArguments, Q509StatesTheLimitsOfTheInterval) {
  const auto withInterval = [](const std::string& tmin, const std::string& tmax) {
    return traceWith("0.0, vec3(0, 0, 1), 1e30", tmin + ", vec3(0, 0, 1), " + tmax);
  };
  const std::string x = "clamp(float(gl_LaunchIDEXT.x), ", start = "Q509 main.rgen:10:3 ",
                    end = ": the interval is empty\n";
  EXPECT_EQ(withInterval("1.0", x + "0.25, 0.5)"), start + "tmin is 1 and tmax is at most 0.5" + end);
  EXPECT_EQ(withInterval(x + "1.0, 2.0)", x + "0.25, 0.5)"),
            start + "tmin is at least 1 and tmax is at most 0.5" + end);
  EXPECT_EQ(withInterval(x + "1.0, 2.0)", x + "0.5, 1.0)"), "") << "both can be 1";
}

TEST(CheckGeometry, Q601ReportsProceduralGeometryWithoutIntersectionShader) {
  const program::SceneFacts boxes = sceneWith({kBalls});
  EXPECT_TRUE(reports(textOf(checkFiles(cleanFiles(), &boxes)), "Q601 program.toml:14:0 ",
                      {"'balls' of scene.glb", "hit group 'surface', ray type 'primary'"}));
  EXPECT_EQ(textOf(checkFiles(boxFiles(), &boxes)), "");
  EXPECT_TRUE(reports(tomlWith(boxFiles(), "shadow = { intersection = \"box.rint\" }", ""), "Q601 program.toml:17:0 ",
                      {"hit group 'boxes', ray type 'shadow'", "different ray type"}));
}

TEST(CheckGeometry, Q602ReportsTrianglesWithIntersectionShader) {
  EXPECT_TRUE(reports(tomlWith(boxFiles(), "geometry = \"procedural\"", "geometry = \"triangles\""),
                      "Q602 program.toml:17:0 ", {"hit group 'boxes'", "triangles"}));
  const program::SceneFacts rock = sceneWith({kStone});
  EXPECT_TRUE(reports(tomlWith(boxFiles(), "geometry = \"procedural\"", "primitives = \"rock\"", &rock),
                      "Q602 program.toml:20:0 ",
                      {"'rock' of scene.glb", "hit group 'boxes', ray type 'primary'", "intersection shader"}));
}

TEST(CheckGeometry, Q603ReportsAnyHitShadersThatNeverRun) {
  const std::vector<std::string> anyHit{"any-hit shader 'cut.rahit' of hit group 'surface', ray type 'primary'"};
  EXPECT_TRUE(reports(traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsOpaqueEXT"), "Q603 program.toml:14:0 ",
                      {anyHit[0], "gl_RayFlagsOpaqueEXT"}));
  EXPECT_TRUE(reports(traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsCullNoOpaqueEXT"), "Q603 program.toml:14:0 ",
                      {anyHit[0], "gl_RayFlagsCullNoOpaqueEXT"}));
  const program::SceneFacts rock = sceneWith({kStone}), leaf = sceneWith({kStone, kLeaf});
  EXPECT_TRUE(reports(textOf(checkFiles(cleanFiles(), &rock)), "Q603 program.toml:14:0 ", {anyHit[0], "in scene.glb"}));
  EXPECT_EQ(textOf(checkFiles(cleanFiles(), &leaf)), "");
  EXPECT_EQ(traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsNoOpaqueEXT", &leaf), "");
  EXPECT_TRUE(reports(tomlWith(cleanFiles(), "name = \"surface\"", "name = \"surface\"\ngeometry = \"opaque\""),
                      "Q603 program.toml:15:0 ", anyHit));
}

TEST(CheckGeometry, Q604ReportsAlphaTestsThatNeverRun) {
  program::SceneFacts leaf = sceneWith({kLeaf});
  const Files bound =
      edited(cleanFiles(), "program.toml", "name = \"surface\"", "name = \"surface\"\ngeometry = \"alpha\"");
  EXPECT_TRUE(reports(tomlWith(bound, ", any_hit = \"cut.rahit\"", "", &leaf), "Q604 program.toml:15:0 ",
                      {"material 'leaf' of scene.glb", "hit group 'surface', ray type 'primary'"}));
  EXPECT_TRUE(
      reports(tomlWith(bound, "{ any_hit = \"cut_shadow.rahit\" }\n", "{}\n", &leaf), "Q604 program.toml:16:0 "));
  EXPECT_TRUE(reports(traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsOpaqueEXT", &leaf), "Q604 main.rgen:10:3 ",
                      {"material 'leaf' of scene.glb", "gl_RayFlagsOpaqueEXT"}));
  EXPECT_EQ(textOf(checkFiles(cleanFiles(), &leaf)), "");
  leaf.instances[0].forceOpaque = true;
  EXPECT_TRUE(reports(textOf(checkFiles(cleanFiles(), &leaf)), "Q604 ", {"instance 'thing'", "forced opaque"}));
  leaf.instances[0].mask = 0x10;
  const std::string masked =
      checkEdited(edited(cleanFiles(), "surface.rchit", "0xFFu", "0x01u"), "main.rgen", "0xFFu", "0x01u", &leaf);
  EXPECT_EQ(masked.find("Q604"), masked.npos) << masked;  // but Q507
}

// A program without any-hit shaders renders all materials as opaque on purpose.
TEST(CheckGeometry, Q604AcceptsProgramsWithoutAnyHitShaders) {
  const program::SceneFacts leaf = sceneWith({kLeaf});
  const Files solid = edited(cleanFiles(), "program.toml", ", any_hit = \"cut.rahit\"", "");
  EXPECT_EQ(tomlWith(solid, "{ any_hit = \"cut_shadow.rahit\" }\n", "{}\n", &leaf), "");
}

// A group that is not bound to class alpha can test alpha for one ray type only, on purpose. But not if a different group
// tests it for that ray type.
TEST(CheckGeometry, Q604AcceptsAnyHitShadersForOneRayType) {
  const program::SceneFacts leaf = sceneWith({kLeaf});
  EXPECT_EQ(tomlWith(cleanFiles(), ", any_hit = \"cut.rahit\"", "", &leaf), "");
  Files solid = edited(cleanFiles(), "program.toml", "{ any_hit = \"cut_shadow.rahit\" }\n", "{}\n");
  EXPECT_EQ(textOf(checkFiles(solid, &leaf)), "");
  solid["program.toml"] +=
      "\n[[hit_group]]\nname = \"stones\"\nmaterial = \"stone\"\nprimary = { closest_hit = \"surface.rchit\" }\nshadow "
      "= "
      "{ any_hit = \"cut_shadow.rahit\" }\n";
  const program::SceneFacts both = sceneWith({kLeaf, kStone});
  EXPECT_THAT(textOf(checkFiles(solid, &both)), HasSubstr("Q604 program.toml:15:0 "));
}

TEST(CheckArguments, Q605ReportsFlagsThatExcludeEachOther) {
  EXPECT_TRUE(reports(traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsOpaqueEXT | gl_RayFlagsCullNoOpaqueEXT"),
                      "Q605 main.rgen:10:3 ", {"gl_RayFlagsOpaqueEXT and gl_RayFlagsCullNoOpaqueEXT"}));
  EXPECT_THAT(
      traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsCullBackFacingTrianglesEXT | gl_RayFlagsCullFrontFacingTrianglesEXT"),
      HasSubstr("Q605"));
  EXPECT_EQ(traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsNoOpaqueEXT | gl_RayFlagsCullBackFacingTrianglesEXT"), "");
}

TEST(CheckGeometry, Q608StatesTheLargestOfTheHitKinds) {
  const auto withKind = [](const std::string& kind) {
    return checkEdited(boxFiles(), "box.rint", "EXT(1.0, 0u)", "EXT(1.0, " + kind + ")");
  };
  const auto message = [](const std::string& kind) {
    return "Q608 box.rint:10:3 the hit kind of this report is " + kind +
           ", but the maximum is 127; Vulkan reserves larger ones for triangles\n";
  };
  const std::string up = "gl_ObjectRayDirectionEXT.x > 0.0 ? ";
  EXPECT_EQ(withKind("127u"), "");
  EXPECT_EQ(withKind("128u"), message("128"));
  EXPECT_EQ(withKind(up + "5u : 127u"), "");
  EXPECT_EQ(withKind("uint[3](5u, 150u, 200u)[gl_LaunchIDEXT.x % 3u]"), message("up to 200"));
  EXPECT_EQ(withKind(up + "150u : 200u"), message("at least 150"));
  EXPECT_EQ(withKind(up + "127u : 128u"), message("up to 128"));
}

TEST(CheckUnused, Q801ReportsUnreachableStages) {
  EXPECT_EQ(tomlWith(cleanFiles(), "shadow = { any_hit", "shadow = { closest_hit = \"surface.rchit\", any_hit"),
            "");  // it runs for a different ray type
  Files files =
      edited(cleanFiles(), "program.toml", "shadow = { any_hit", "shadow = { closest_hit = \"late.rchit\", any_hit");
  files["late.rchit"] =
      kHead + std::string("layout(location = 1) rayPayloadInEXT Shadow payload;\nvoid main() { payload.lit = 0u; }\n");
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(files)), "Q801 program.toml:15:0 ", {"closest-hit shader 'late.rchit'"}));
  Files calls = callFiles();
  calls["main.rgen"] = changed(calls["main.rgen"], "executeCallableEXT(0u, 0);", "");
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(calls)), "Q801 program.toml:3:0 ", {"callable shader 'tint.rcall'"}));
}

TEST(CheckUnused, Q802ReportsHitGroupsWithoutGeometry) {
  Files files = cleanFiles();
  files["program.toml"] +=
      "\n[[hit_group]]\nname = \"more\"\nprimary = { closest_hit = \"surface.rchit\" }\nshadow = { any_hit = "
      "\"cut_shadow.rahit\" }\n";
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(files)), "Q802 program.toml:17:0 ",
                          {"hit group 'more'", "hit group 'surface' has the same binding"}));
  const program::SceneFacts scene = sceneWith({kStone, kLeaf});
  const Files bound = edited(files, "program.toml", "name = \"more\"", "name = \"more\"\nmaterial = \"leef\"");
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(bound, &scene)), "Q802 program.toml:17:0 ",
                          {"hit group 'more'", "scene.glb has no material 'leef' (did you mean 'leaf'?)"}));
  EXPECT_EQ(textOf(checkFiles(bound)), "");
  const program::SceneFacts other = sceneWith({kStone, {program::GeometryKind::triangles, true, "tree", "leef"}});
  EXPECT_THAT(textOf(checkFiles(bound, &other)), Not(HasSubstr("Q802")));
}

// The boxes of glass use the group for triangles, because the name of their material is misspelled.
TEST(CheckUnused, Q802IsReportedInsteadOfItsConsequences) {
  Files files = boxFiles();
  files["program.toml"] = changed(files["program.toml"], "geometry = \"procedural\"", "material = \"glas\"");
  const program::SceneFacts scene = sceneWith({kLeaf, kBalls});
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(files, &scene)), "Q802 program.toml:17:0 ",
                          {"no material 'glas' (did you mean 'glass'?)"}));
  // Without a near name, both are reported.
  const Files other = edited(files, "program.toml", "\"glas\"", "\"wood\"");
  EXPECT_TRUE(reports(textOf(checkFiles(other, &scene)), "Q802 program.toml:17:0 ", {"'wood'"}));
  EXPECT_TRUE(reports(textOf(checkFiles(other, &scene)), "Q601 program.toml:14:0 ", {"'balls'"}));
}

TEST(Check, ListsReachableStages) {
  EXPECT_THAT(checkFiles(cleanFiles()).reached,
              testing::UnorderedElementsAre("main.rgen", "sky.rmiss", "lit.rmiss", "surface.rchit", "cut.rahit",
                                            "cut_shadow.rahit"));
}

TEST(Check, ReturnsCompilerErrors) {
  const CheckResult result = checkFiles(edited(cleanFiles(), "sky.rmiss", "-1.0;", "-1.0"));
  EXPECT_FALSE(result.ok());
  EXPECT_TRUE(reports(textOf(result), "GLSL sky.rmiss:"));
}

}  // namespace
}  // namespace quintet::check
