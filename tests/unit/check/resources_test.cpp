// SPDX-License-Identifier: Apache-2.0
// Q651 to Q654: forms of descriptors, push constants and records that the corpus of mistakes does not have.
#include "check_test_support.h"
#include "quintet/shared/bindings.h"

namespace quintet::check {
namespace {

std::string idsOf(const CheckResult& result) {
  std::string ids;
  for (const Diagnostic& d : result.diagnostics) ids += (ids.empty() ? "" : " ") + d.id;
  return ids;
}

// The clean program with declarations and a statement in its ray generation shader.
CheckResult checkWith(const std::string& declarations, const std::string& statement, const std::string& toml = "") {
  Files files = cleanFiles();
  files["program.toml"] += toml;
  files["main.rgen"] = changed(files["main.rgen"], "void main() {", declarations + "\nvoid main() {");
  files["main.rgen"] = changed(files["main.rgen"], "  addOutput(0u", "  " + statement + "\n  addOutput(0u");
  return checkFiles(files);
}

std::string idsWith(const std::string& declarations, const std::string& statement, const std::string& toml = "") {
  return idsOf(checkWith(declarations, statement, toml));
}

// The library's own declarations, which the driver gets, are what the check accepts.
TEST(Resources, OfTheLibraryAreProvided) {
  EXPECT_EQ(idsWith("#include <quintet/texture.glsl>",
                    "color += textureLod(textures[launch.firstSample], vec2(0.5), 0.0).rgb + vec3(launch.offset, "
                    "launch.sampleCount) + vec3(frame.width, launch.parameterAddress != 0ul, launch.tiles != 0ul);"),
            "");
}

TEST(Resources, ListsTheBindings) {
  const CheckResult result =
      checkWith("layout(set = 2, binding = 5) uniform sampler2D own;", "color += textureLod(own, vec2(0.5), 0.0).rgb;");
  ASSERT_EQ(idsOf(result), "Q651");
  const std::string& text = result.diagnostics[0].text;
  EXPECT_THAT(text, testing::HasSubstr("'own' is sampler2D at set 2, binding 5"));
  for (const shared::Binding& binding : shared::kBindings)
    EXPECT_THAT(text, testing::HasSubstr("binding " + std::to_string(binding.number) + " " + binding.glsl + " (" +
                                         binding.constant + ")"));
}

TEST(Resources, UnusedOnesAreNotReported) {
  EXPECT_EQ(idsWith("layout(set = 0, binding = 7) uniform sampler2D own;", ""), "");
  EXPECT_EQ(idsWith("layout(shaderRecordEXT, std430) buffer Own { vec4 color; } own;", ""), "");
}

TEST(Resources, NamesTheTypesOfImages) {
  const auto typeOf = [](const std::string& declaration, const std::string& use) {
    const CheckResult result = checkWith("layout(set = 0, binding = 1" + declaration, use);
    if (result.diagnostics.empty()) return std::string("accepted");
    const std::string& text = result.diagnostics[0].text;
    const std::size_t begin = text.find(" is ") + 4;
    return text.substr(begin, text.find(" at ") - begin);
  };
  EXPECT_EQ(typeOf(") uniform usampler2D t[3];", "color.x += float(texelFetch(t[1], ivec2(0), 0).x);"),
            "usampler2D[3]");
  EXPECT_EQ(typeOf(") uniform sampler3D t;", "color += textureLod(t, vec3(0.5), 0.0).rgb;"), "sampler3D");
  EXPECT_EQ(typeOf(") uniform sampler2DArray t;", "color += textureLod(t, vec3(0.5), 0.0).rgb;"), "sampler2DArray");
  EXPECT_EQ(typeOf(") uniform sampler2DShadow t;", "color.x += textureLod(t, vec3(0.5), 0.0);"), "sampler2DShadow");
  EXPECT_EQ(typeOf(", r32ui) uniform uimage2D t;", "color.x += float(imageLoad(t, ivec2(0)).x);"), "uimage2D");
  EXPECT_EQ(typeOf(") uniform sampler2D t[3];", "color += textureLod(t[1], vec2(0.5), 0.0).rgb;"), "accepted");
}

// The rgen stage includes <quintet/output.glsl>, so another block goes to the miss shader.
std::string idsOfPushConstants(const std::string& block, const std::string& use) {
  Files files = cleanFiles();
  files["sky.rmiss"] =
      changed(files["sky.rmiss"], "void main() {",
              "#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require\n" + block + "\nvoid main() {");
  files["sky.rmiss"] = changed(files["sky.rmiss"], "payload.t = -1.0;", "payload.t = -1.0 - float(" + use + ");");
  return idsOf(checkFiles(files));
}

TEST(Resources, PartsOfThePushConstantsAreProvided) {
  EXPECT_EQ(idsOfPushConstants("layout(push_constant) uniform P { uint64_t frame; } p;", "p.frame & 1ul"), "");
  EXPECT_EQ(idsOfPushConstants("layout(push_constant) uniform P { uvec2 frame; } p;", "p.frame.x"), "");
  EXPECT_EQ(idsOfPushConstants("layout(push_constant) uniform P { layout(offset = 16) uvec2 pixel; } p;", "p.pixel.y"),
            "");
  EXPECT_EQ(idsOfPushConstants("layout(push_constant) uniform P { layout(offset = 28) int count; } p;", "p.count"), "");
  EXPECT_EQ(idsOfPushConstants("struct L { uint64_t f; uint64_t p; uvec2 o; uint s; uint c; uint64_t t; };\n"
                               "layout(push_constant) uniform P { L l; } p;",
                               "p.l.c + p.l.s"),
            "");
}

TEST(Resources, OtherPushConstantsAreReported) {
  EXPECT_EQ(idsOfPushConstants("layout(push_constant) uniform P { uint frame; } p;", "p.frame"), "Q652");
  EXPECT_EQ(idsOfPushConstants("layout(push_constant) uniform P { layout(offset = 24) uint64_t a; } p;", "p.a & 1ul"),
            "Q652");
  EXPECT_EQ(idsOfPushConstants("layout(push_constant) uniform P { float a[4]; } p;", "p.a[1]"), "Q652");
  EXPECT_EQ(idsOfPushConstants("layout(push_constant) uniform P { mat4 m; } p;", "p.m[1].x"), "Q652");
  EXPECT_EQ(idsOfPushConstants("layout(push_constant) uniform P { uvec4 four; } p;", "p.four.x"), "Q652");
}

constexpr const char* kFields =
    "\n[[record]]\nname = \"level\"\ntype = \"int\"\ndefault = 1\n\n[[record]]\nname = \"tint\"\ntype = \"color\"\n"
    "default = [1.0, 1.0, 1.0]\n";

std::string idsOfRecord(const std::string& layout, const std::string& members) {
  return idsWith("#extension GL_EXT_scalar_block_layout : require\nlayout(shaderRecordEXT, " + layout +
                     ") buffer R { " + members + " } r;",
                 "color += r.tint;", kFields);
}

TEST(Resources, RecordsOfTheSameTypeAreProvided) {
  EXPECT_EQ(idsOfRecord("scalar", "int level; vec3 tint;"), "");
  EXPECT_EQ(idsOfRecord("scalar", "uint level; vec3 tint;"), "");  // the same bits
  EXPECT_EQ(idsOfRecord("std430", "layout(offset = 4) float red; layout(offset = 16) vec3 tint;"), "Q653");
  EXPECT_EQ(idsOfRecord("scalar", "layout(offset = 4) vec3 tint;"), "");
}

TEST(Resources, RecordsOfAnotherTypeAreReported) {
  EXPECT_EQ(idsOfRecord("std430", "int level; vec3 tint;"), "Q653");
  EXPECT_EQ(idsOfRecord("scalar", "float level; vec3 tint;"), "Q653");
  EXPECT_EQ(idsOfRecord("scalar", "vec3 tint; int level;"), "Q653");
  EXPECT_EQ(idsWith("#extension GL_EXT_scalar_block_layout : require\nlayout(shaderRecordEXT, scalar) buffer R { vec3 "
                    "tint; } r;",
                    "color += r.tint;"),
            "Q654");
}

}  // namespace
}  // namespace quintet::check
