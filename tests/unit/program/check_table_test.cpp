// Q201 ... Q203, Q401, Q402, Q501 ... Q506, Q601 ... Q605, Q801, Q802.
#include "check_test_support.h"

namespace quintet::program {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

// The arguments of ray generation's trace.
std::string traceWith(const std::string& from, const std::string& to, const SceneFacts* scene = nullptr) {
  return checkEdited(cleanFiles(), "main.rgen", from, to, scene);
}

std::string tomlWith(const Files& files, const std::string& from, const std::string& to,
                     const SceneFacts* scene = nullptr) {
  return checkEdited(files, "program.toml", from, to, scene);
}

const GeometryFacts kStone{GeometryKind::triangles, false, "rock", "stone"};
const GeometryFacts kLeaf{GeometryKind::triangles, true, "tree", "leaf"};
const GeometryFacts kBalls{GeometryKind::custom, false, "balls", "glass"};

TEST(CheckAttributes, Q201TypeDiffers) {
  const Files files = edited(boxFiles(), "box.rchit", "hit.normal;", "vec3(hit.normal, 0.0);");
  EXPECT_EQ(checkEdited(files, "box.rchit", "struct Hit { vec3 normal; }", "struct Hit { vec2 normal; }"),
            "Q201 box.rchit:8:21 hit attribute 'hit' is struct Hit { vec2 normal; } here, but the intersection shader "
            "'box.rint' of hit group 'boxes', ray "
            "type 'primary' writes struct Hit { vec3 normal; }: member 0 'normal': vec3 against vec2\n");
}

TEST(CheckAttributes, Q202TrianglesHaveBarycentrics) {
  EXPECT_EQ(checkEdited(cleanFiles(), "cut.rahit", "hitAttributeEXT vec2", "hitAttributeEXT vec3"),
            "Q202 cut.rahit:7:22 hit attribute 'attribs' is vec3, but hit group 'surface', ray type 'primary' is for "
            "triangles, whose attribute is vec2\n");
}

TEST(CheckAttributes, Q203TooLarge) {
  Files files = boxFiles();
  for (const char* file : {"box.rint", "box.rchit"})
    files[file] = changed(files[file], "vec3 normal;", "vec3 normal; mat2x3 frame;");
  files["box.rint"] = changed(files["box.rint"], "hit.normal =", "hit.frame = mat2x3(1.0); hit.normal =");
  EXPECT_THAT(textOf(checkFiles(files)), HasSubstr("Q203 box.rint:7:21 hit attribute 'hit', struct Hit { vec3 normal; "
                                                   "mat2x3 frame; }, has 36 bytes; Vulkan allows 32\n"));
  DeviceLimits limits;
  limits.name = "a device";
  limits.maxHitAttributeBytes = 36;
  EXPECT_EQ(textOf(checkFiles(files, nullptr, limits)), "");
}

TEST(CheckRecursion, DepthIsTheLongestChain) {
  EXPECT_EQ(checkFiles(cleanFiles()).recursionDepth, 2u);
  EXPECT_EQ(checkFiles(boxFiles()).recursionDepth, 2u);
  EXPECT_EQ(checkFiles(cleanFiles()).stackBytes, 16u + (8u + 4u) + 8u);  // ray generation, closest-hit, any-hit
}

// The shadow ray runs closest-hit shaders: these trace shadow rays.
constexpr const char* kShadowFlags =
    "gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_shadow";

TEST(CheckRecursion, Q401CycleWithoutABound) {
  const Files cycle =
      edited(cleanFiles(), "surface.rchit", kShadowFlags, "gl_RayFlagsTerminateOnFirstHitEXT, 0xFFu, kRay_primary");
  EXPECT_THAT(
      textOf(checkFiles(cycle)),
      HasSubstr(
          "Q401 surface.rchit:13:3 this trace can run its own stage again, the closest-hit shader 'surface.rchit'"));
  const Files bounded = edited(cycle, "program.toml", "ray_generation", "max_recursion = 5\nray_generation");
  EXPECT_THAT(textOf(checkFiles(bounded)), Not(HasSubstr("Q40")));
  EXPECT_EQ(checkFiles(bounded).recursionDepth, 5u);
}

TEST(CheckRecursion, Q402DeeperThanDeclaredOrPossible) {
  EXPECT_EQ(tomlWith(cleanFiles(), "ray_generation", "max_recursion = 1\nray_generation"),
            "Q402 surface.rchit:13:3 traces nest 2 deep (main.rgen:10 -> surface.rchit:13 -> lit.rmiss), but the "
            "program declares 1\n");
  DeviceLimits limits;
  limits.name = "a device";
  limits.maxRecursion = 1;
  EXPECT_EQ(textOf(checkFiles(cleanFiles(), nullptr, limits)),
            "Q402 surface.rchit:13:3 traces nest 2 deep (main.rgen:10 -> surface.rchit:13 -> lit.rmiss); a device "
            "allows 1\n");
}

// Callable shaders c0 to c3; each calls the next one of `calls`.
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
  std::string text = program::textOf(checkFiles(files)), result;
  for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
    if (!text.substr(at).starts_with("Q801") && !text.substr(at).starts_with("Q104"))
      result += text.substr(at, text.find('\n', at) + 1 - at);
  return result;
}

TEST(CheckRecursion, CallsNestTwoDeep) {
  EXPECT_EQ(callChain("1..."), "");
  EXPECT_EQ(callChain("12.."),
            "Q402 main.rgen:12:3 calls nest 3 deep from here, over the callable shader 'c0.rcall' (callable index 0); "
            "the stack has room for 2\n");
  EXPECT_EQ(callChain("10.."),
            "Q401 c1.rcall:10:3 this call closes a cycle: the callable shader 'c0.rcall' (callable index 0) can call "
            "itself again\n");
}

TEST(CheckTable, Q501OffsetBeyondTheRecords) {
  EXPECT_THAT(traceWith("0xFFu, kRay_primary", "0xFFu, 2u"),
              HasSubstr("Q501 main.rgen:10:3 the offset of this trace is 2, but each geometry has 2 records (one for "
                        "each ray type)"));
  const SceneFacts scene = sceneWith({kStone, kStone});
  EXPECT_THAT(traceWith("0xFFu, kRay_primary", "0xFFu, 2u", &scene),
              HasSubstr(": instance 'thing' of scene.glb uses record 4; the table has 4\n"));
}

TEST(CheckTable, Q501StrideOfAnotherProgram) {
  const std::string stride = ", kRayTypeCount, kMiss_primary, ";
  EXPECT_THAT(traceWith(stride, ", 1u, kMiss_primary, "),
              HasSubstr("Q501 main.rgen:10:3 the stride of this trace is 1"));
  const SceneFacts one = sceneWith({kLeaf}), two = sceneWith({kStone, kLeaf});
  EXPECT_EQ(traceWith(stride, ", 1u, kMiss_primary, ", &one), "");
  EXPECT_THAT(traceWith(stride, ", 3u, kMiss_primary, ", &two),
              HasSubstr("geometry 1 of instance 'thing' uses record 3, its own is 2"));
  EXPECT_THAT(traceWith(stride, ", 5u, kMiss_primary, ", &two),
              HasSubstr("uses record 5, its own is 2; the table has 4"));
  EXPECT_EQ(traceWith(stride, ", 0u, kMiss_primary, "), "");  // every geometry as the first
}

TEST(CheckTable, Q502MissIndex) {
  EXPECT_THAT(
      traceWith("kMiss_primary, vec3", "2u, vec3"),
      HasSubstr("Q502 main.rgen:10:3 the miss index of this trace is 2, but the program has 2 miss shaders: 0 to 1\n"));
}

TEST(CheckTable, Q503FourBits) {
  EXPECT_THAT(traceWith(", kRayTypeCount, kMiss_primary, ", ", 16u, kMiss_primary, "),
              HasSubstr("Q503 main.rgen:10:3 the stride of this trace is 16; at most 15"));
  EXPECT_THAT(traceWith("0xFFu, kRay_primary", "0xFFu, 18u"),
              HasSubstr("Q503 main.rgen:10:3 the offset of this trace is 18"));
}

TEST(CheckTable, Q504SixteenBits) {
  EXPECT_THAT(
      traceWith("kMiss_primary, vec3", "65536u, vec3"),
      HasSubstr(
          "Q504 main.rgen:10:3 the miss index of this trace is 65536; at most 65535 is possible, and 0 would be used"));
}

TEST(CheckTable, Q505EightBits) {
  EXPECT_EQ(traceWith("0xFFu, kRay_primary", "0x100u, kRay_primary"),
            "Q505 main.rgen:10:3 the cull mask of this trace is 0x100; its 8 low bits are 0x00\n");
}

TEST(CheckTable, Q506ShadowRayWithTheRadianceMiss) {
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
  EXPECT_THAT(checkEdited(files, "surface.rchit", "kMiss_shadow,\n", "kMiss_primary,\n"),
              HasSubstr("Q506 surface.rchit:13:3 this shadow ray runs miss shader 'sky.rmiss' (index 0), which "
                        "radiance rays use; no trace of radiance uses 'lit.rmiss' (index 1)\n"));
}

TEST(CheckGeometry, Q601BoxesWithoutIntersection) {
  const SceneFacts boxes = sceneWith({kBalls});
  EXPECT_THAT(textOf(checkFiles(cleanFiles(), &boxes)),
              HasSubstr("Q601 program.toml:14:0 the boxes of 'balls' of scene.glb are served by hit group 'surface', "
                        "ray type 'primary', which has no intersection shader\n"));
  EXPECT_EQ(textOf(checkFiles(boxFiles(), &boxes)), "");
  EXPECT_THAT(tomlWith(boxFiles(), "shadow = { intersection = \"box.rint\" }", ""),
              StartsWith("Q601 program.toml:17:0 hit group 'boxes', ray type 'shadow' has no intersection shader, but "
                         "the group has one for another ray type"));
}

TEST(CheckGeometry, Q602TrianglesWithIntersection) {
  EXPECT_THAT(tomlWith(boxFiles(), "geometry = \"procedural\"", "geometry = \"triangles\""),
              HasSubstr("Q602 program.toml:17:0 hit group 'boxes' is bound to triangles"));
  const SceneFacts rock = sceneWith({kStone});
  EXPECT_THAT(tomlWith(boxFiles(), "geometry = \"procedural\"", "primitives = \"rock\"", &rock),
              HasSubstr("Q602 program.toml:20:0 the triangles of 'rock' of scene.glb are served by hit group 'boxes', "
                        "ray type 'primary', whose intersection shader is for boxes\n"));
}

TEST(CheckGeometry, Q603AnyHitNeverRuns) {
  EXPECT_THAT(traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsOpaqueEXT"),
              StartsWith("Q603 program.toml:14:0 any-hit shader 'cut.rahit' of hit group 'surface', ray type 'primary' "
                         "never runs: every trace of that ray type has gl_RayFlagsOpaqueEXT\n"));
  const SceneFacts rock = sceneWith({kStone}), leaf = sceneWith({kStone, kLeaf});
  EXPECT_THAT(textOf(checkFiles(cleanFiles(), &rock)),
              HasSubstr("never runs: all that the group serves in scene.glb is opaque\n"));
  EXPECT_EQ(textOf(checkFiles(cleanFiles(), &leaf)), "");
  EXPECT_EQ(traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsNoOpaqueEXT", &leaf), "");
  EXPECT_THAT(tomlWith(cleanFiles(), "name = \"surface\"", "name = \"surface\"\ngeometry = \"opaque\""),
              HasSubstr("Q603 program.toml:15:0 any-hit shader 'cut.rahit' of hit group 'surface', ray type 'primary' "
                        "never runs: the group is for opaque geometry\n"));
}

TEST(CheckGeometry, Q604AlphaLooksSolid) {
  SceneFacts leaf = sceneWith({kLeaf});
  EXPECT_THAT(tomlWith(cleanFiles(), ", any_hit = \"cut.rahit\"", "", &leaf),
              HasSubstr("Q604 program.toml:14:0 material 'leaf' of scene.glb looks solid to this ray type: hit group "
                        "'surface', ray type 'primary' has no any-hit shader\n"));
  EXPECT_THAT(tomlWith(cleanFiles(), "{ any_hit = \"cut_shadow.rahit\" }\n", "{}\n", &leaf),
              HasSubstr("Q604 program.toml:15:0 "));
  EXPECT_THAT(
      traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsOpaqueEXT", &leaf),
      HasSubstr(
          "Q604 main.rgen:10:3 material 'leaf' of scene.glb looks solid to this trace: with gl_RayFlagsOpaqueEXT"));
  EXPECT_EQ(textOf(checkFiles(cleanFiles(), &leaf)), "");
  leaf.instances[0].forceOpaque = true;
  EXPECT_THAT(textOf(checkFiles(cleanFiles(), &leaf)),
              HasSubstr("looks solid on instance 'thing', which is forced opaque"));
  leaf.instances[0].mask = 0x10;
  EXPECT_THAT(
      checkEdited(edited(cleanFiles(), "surface.rchit", "0xFFu", "0x01u"), "main.rgen", "0xFFu", "0x01u", &leaf),
      IsEmpty());
}

// A program without any any-hit shader draws everything solid on purpose.
TEST(CheckGeometry, Q604NotForProgramsWithoutAlpha) {
  const SceneFacts leaf = sceneWith({kLeaf});
  const Files solid = edited(cleanFiles(), "program.toml", ", any_hit = \"cut.rahit\"", "");
  EXPECT_EQ(tomlWith(solid, "{ any_hit = \"cut_shadow.rahit\" }\n", "{}\n", &leaf), "");
}

TEST(CheckGeometry, Q605ContradictingFlags) {
  EXPECT_THAT(traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsOpaqueEXT | gl_RayFlagsCullNoOpaqueEXT"),
              HasSubstr("Q605 main.rgen:10:3 this trace has gl_RayFlagsOpaqueEXT and gl_RayFlagsCullNoOpaqueEXT, which "
                        "exclude each other\n"));
  EXPECT_THAT(
      traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsCullBackFacingTrianglesEXT | gl_RayFlagsCullFrontFacingTrianglesEXT"),
      HasSubstr("Q605"));
  EXPECT_EQ(traceWith("gl_RayFlagsNoneEXT", "gl_RayFlagsNoOpaqueEXT | gl_RayFlagsCullBackFacingTrianglesEXT"), "");
}

TEST(CheckUnused, Q801NobodyReaches) {
  EXPECT_EQ(tomlWith(cleanFiles(), "shadow = { any_hit", "shadow = { closest_hit = \"surface.rchit\", any_hit"),
            "");  // for another ray type it runs
  Files files =
      edited(cleanFiles(), "program.toml", "shadow = { any_hit", "shadow = { closest_hit = \"late.rchit\", any_hit");
  files["late.rchit"] =
      kHead + std::string("layout(location = 1) rayPayloadInEXT Shadow payload;\nvoid main() { payload.lit = 0u; }\n");
  EXPECT_EQ(textOf(checkFiles(files)),
            "Q801 program.toml:15:0 no trace or call can run the closest-hit shader 'late.rchit'\n");
  Files calls = callFiles();
  calls["main.rgen"] = changed(calls["main.rgen"], "executeCallableEXT(0u, 0);", "");
  EXPECT_EQ(textOf(checkFiles(calls)),
            "Q801 program.toml:3:0 no trace or call can run the callable shader 'tint.rcall'\n");
}

TEST(CheckUnused, Q802GroupServesNothing) {
  Files files = cleanFiles();
  files["program.toml"] +=
      "\n[[hit_group]]\nname = \"more\"\nprimary = { closest_hit = \"surface.rchit\" }\nshadow = { any_hit = "
      "\"cut_shadow.rahit\" }\n";
  EXPECT_EQ(textOf(checkFiles(files)),
            "Q802 program.toml:17:0 hit group 'more' serves nothing: hit group 'surface' has the same binding and "
            "comes first\n");
  const SceneFacts scene = sceneWith({kStone, kLeaf});
  const Files bound = edited(files, "program.toml", "name = \"more\"", "name = \"more\"\nmaterial = \"leef\"");
  EXPECT_EQ(textOf(checkFiles(bound, &scene)),
            "Q802 program.toml:17:0 hit group 'more' serves nothing: scene.glb has no material 'leef'\n");
  EXPECT_EQ(textOf(checkFiles(bound)), "");
  const SceneFacts other = sceneWith({kStone, {GeometryKind::triangles, true, "tree", "leef"}});
  EXPECT_THAT(textOf(checkFiles(bound, &other)), Not(HasSubstr("Q802")));
}

TEST(CheckUnused, ReachedStagesAreListed) {
  EXPECT_THAT(checkFiles(cleanFiles()).reached,
              testing::UnorderedElementsAre("main.rgen", "sky.rmiss", "lit.rmiss", "surface.rchit", "cut.rahit",
                                            "cut_shadow.rahit"));
}

TEST(Check, ShadersThatDoNotCompileAreTheResult) {
  const CheckResult result = checkFiles(edited(cleanFiles(), "sky.rmiss", "-1.0;", "-1.0"));
  EXPECT_FALSE(result.ok());
  EXPECT_THAT(textOf(result), StartsWith("GLSL sky.rmiss:"));
}

}  // namespace
}  // namespace quintet::program
