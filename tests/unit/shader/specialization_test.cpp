// SPDX-License-Identifier: Apache-2.0
// Modules that are compiled once and specialized for each scene.
#include "shader/specialization.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "quintet/shared/features.h"
#include "shader/library.h"
#include "shader_test_support.h"
#include "spirv/module.h"

namespace quintet::shader {
namespace {

using testing::ElementsAre;
using testing::Pair;

constexpr std::uint32_t kSheenMark = 123456789, kTextureMark = 987654321;

// Contains kSheenMark only with sheen, kTextureMark only with texture 3.
Source markedSource() {
  return computeSource("#include <quintet/features.glsl>",
                       "b.x = 1; if (kHasSheen) b.x = 123456789; if ((kTextureSlots & 8u) != 0u) b.x += 987654321;");
}

bool has(const std::vector<std::uint32_t>& words, std::uint32_t mark) {
  return std::ranges::find(words, mark) != words.end();
}

// A compiler that has `module`, which must outlive it.
Compiler compilerWith(const ShippedModule& module, std::vector<EmbeddedFile>& files, std::string& name) {
  name = shippedName(module.key);
  files = {{name, {reinterpret_cast<const char*>(module.spirv.data()), module.spirv.size() * sizeof(std::uint32_t)}}};
  CompilerOptions options;
  options.shipped = files;
  return Compiler(options);
}

TEST(Specialization, DefinitionsOfFeaturesBecomeValues) {
  Source source;
  source.defines = {{"QUINTET_NO_SHEEN", "1"}, {"QUINTET_NO_SEEDS", "1"}, {"QUINTET_TEXTURE_SLOTS", "0x1fu"}};
  const std::optional<GenericSource> generic = makeGeneric(source);
  ASSERT_TRUE(generic);
  EXPECT_THAT(generic->source.defines, ElementsAre(Pair("QUINTET_SPECIALIZE", "1"), Pair("QUINTET_NO_SEEDS", "1")));
  EXPECT_EQ(generic->values.at(QUINTET_ID_SHEEN), 0u);
  EXPECT_EQ(generic->values.at(QUINTET_ID_CLEARCOAT), 1u);
  EXPECT_EQ(generic->values.at(QUINTET_ID_TEXTURE_SLOTS), 0x1Fu);
}

TEST(Specialization, OtherValuesOfFeaturesAreCompiled) {
  for (const auto& define : {std::pair<std::string, std::string>{"QUINTET_NO_SHEEN", "true"},
                             {"QUINTET_TEXTURE_SLOTS", "31"},
                             {"QUINTET_TEXTURE_SLOTS", "0xu"},
                             {"QUINTET_TEXTURE_SLOTS", "0x1ffffffffu"}}) {
    Source source;
    source.defines = {define};
    EXPECT_FALSE(makeGeneric(source)) << define.second;
  }
}

// A constant of features.glsl whose value nothing sets would always be true.
TEST(Specialization, EveryConstantOfTheLibraryHasAValue) {
  const auto library = embeddedShaderLibrary();
  const auto file = std::ranges::find(library, "quintet/features.glsl", &EmbeddedFile::path);
  ASSERT_NE(file, library.end());
  std::size_t constants = 0;
  for (std::size_t at = 0; (at = file->data.find("constant_id = QUINTET_ID_", at)) != std::string_view::npos; ++at) {
    const std::size_t begin = at + std::strlen("constant_id = QUINTET_ID_");
    const std::string name(file->data.substr(begin, file->data.find(')', begin) - begin));
    Source without;
    without.defines = {name == "TEXTURE_SLOTS" ? std::pair<std::string, std::string>("QUINTET_TEXTURE_SLOTS", "0x0u")
                                               : std::pair<std::string, std::string>("QUINTET_NO_" + name, "1")};
    const std::optional<GenericSource> generic = makeGeneric(without);
    ASSERT_TRUE(generic) << name;
    EXPECT_EQ(generic->source.defines.size(), 1u) << name << " stays a definition";
    EXPECT_EQ(std::ranges::count(generic->values, 0u, &FeatureValues::value_type::second), 1) << name;
    ++constants;
  }
  EXPECT_EQ(constants, makeGeneric({})->values.size());
}

TEST(Specialization, RemovesWhatTheSceneLacks) {
  const ShippedModule module = Compiler({}).ship(markedSource());
  EXPECT_TRUE(has(module.spirv, kSheenMark) && has(module.spirv, kTextureMark));
  std::vector<EmbeddedFile> files;
  std::string name;
  const Compiler compiler = compilerWith(module, files, name);
  for (const bool sheen : {false, true})
    for (const bool textured : {false, true}) {
      Source source = markedSource();
      if (!sheen) source.defines.emplace_back("QUINTET_NO_SHEEN", "1");
      source.defines.emplace_back("QUINTET_TEXTURE_SLOTS", textured ? "0xcu" : "0x4u");
      const Result result = compiler.compile(source);
      ASSERT_TRUE(result.ok()) << all(result);
      EXPECT_TRUE(result.shipped);
      EXPECT_EQ(has(result.spirv, kSheenMark), sheen);
      // With both, the optimizer knows only one of the summands.
      if (!sheen) {
        EXPECT_EQ(has(result.spirv, kTextureMark) || has(result.spirv, kTextureMark + 1), textured);
      }
    }
}

TEST(Specialization, ChangedSourcesAreCompiled) {
  const ShippedModule module = Compiler({}).ship(markedSource());
  std::vector<EmbeddedFile> files;
  std::string name;
  const Compiler compiler = compilerWith(module, files, name);
  EXPECT_TRUE(compiler.compile(markedSource()).shipped);

  Source changed = markedSource();
  changed.text += "// changed\n";
  EXPECT_FALSE(compiler.compile(changed).shipped);

  Source unoptimized = markedSource();
  unoptimized.optimize = false;
  EXPECT_FALSE(compiler.compile(unoptimized).shipped);

  Source included = markedSource();
  included.virtualFiles["quintet/shared/features.h"] = "// changed\n";
  EXPECT_FALSE(compiler.compile(included).shipped);

  // A definition counts if a text uses it.
  Source defined = markedSource();
  defined.defines.emplace_back("UNUSED", "1");
  EXPECT_TRUE(compiler.compile(defined).shipped);
  defined.defines.emplace_back("QUINTET_NO_SEEDS", "1");
  EXPECT_FALSE(compiler.compile(defined).shipped);
}

TEST(Specialization, ALibraryOnDiskIsCompiled) {
  const TemporaryFolder folder;
  for (const EmbeddedFile& file : embeddedShaderLibrary()) folder.write(std::string(file.path), file.data);
  const ShippedModule module = Compiler({}).ship(markedSource());
  const std::string name = shippedName(module.key);
  const std::vector<EmbeddedFile> files = {
      {name, {reinterpret_cast<const char*>(module.spirv.data()), module.spirv.size() * sizeof(std::uint32_t)}}};
  CompilerOptions options;
  options.shipped = files;
  options.libraryOverride = folder.path();
  folder.write("quintet/shared/features.h", "#define QUINTET_ID_TEXTURE_SLOTS 0 // other\n");
  EXPECT_FALSE(Compiler(options).compile(markedSource()).shipped);
}

TEST(Specialization, ShipsOnlyWithoutMessages) {
  EXPECT_THROW((void)Compiler({}).ship(computeSource("int f() { return nowhere; }")), Error);
}

TEST(Specialization, TypesAndGlobalVariablesKeepTheirNames) {
  const std::vector<std::uint32_t> words =
      Compiler({})
          .ship(computeSource("struct Item { int member; }; layout(binding = 1) buffer Items { Item list[]; } items;",
                              "int local = items.list[0].member; b.x = local * local;"))
          .spirv;
  const std::optional<spirv::Module> module = spirv::Module::read(words);
  ASSERT_TRUE(module);
  const auto named = [&](const char* name) {
    return std::ranges::any_of(module->variables(), [&](const spirv::Variable& v) { return v.name == name; });
  };
  EXPECT_TRUE(named("items"));
  const std::string text(reinterpret_cast<const char*>(words.data()), words.size() * sizeof(std::uint32_t));
  EXPECT_NE(text.find("member"), std::string::npos);
  EXPECT_EQ(text.find("local"), std::string::npos);
  EXPECT_EQ(text.find("#version"), std::string::npos);
}

}  // namespace
}  // namespace quintet::shader
