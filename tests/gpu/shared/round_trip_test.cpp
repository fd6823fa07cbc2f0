// SPDX-License-Identifier: Apache-2.0
// Every struct of quintet/shared/*.h has the same layout in C++ and GLSL, for each member and in both directions.
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <regex>
#include <set>

#include "fields.h"
#include "harness.h"
#include "quintet/shared/albedo.h"
#include "quintet/shared/film.h"
#include "shader/library.h"

namespace quintet::test {
namespace {

// All words are different and finite floats, because some devices change signaling NaNs to quiet NaNs.
std::uint32_t pattern(std::size_t i) { return 0x40010203u + static_cast<std::uint32_t>(i) * 0x00030507u; }

template <class T>
T filled() {
  Words words(sizeof(T) / 4);
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = pattern(i);
  T value;
  std::memcpy(&value, words.data(), sizeof(T));
  return value;
}

struct AllWords {
  std::uint32_t at[256];
};

// The start of the shader: all structs, and put and take for T and the structs in it.
template <class T>
std::string glslFor() {
  return std::string(
             "#include <quintet/shared/film.h>\n#include <quintet/shared/instrument.h>\n"
             "#include <quintet/shared/explain.h>\n#include <quintet/shared/heat.h>\n"
             "#include <quintet/shared/deform.h>\n") +
         kGlslWords + Fields<shared::TextureData>::glsl() + Fields<shared::EnvironmentData>::glsl() +
         Fields<shared::CameraData>::glsl() + Fields<shared::FilmBatch>::glsl() +
         (std::set<std::string>{"TextureData", "EnvironmentData", "CameraData", "FilmBatch"}.contains(Fields<T>::kName)
              ? ""
              : Fields<T>::glsl()) +
         "struct AllWords { uint at[256]; };\n";
}

template <class T>
class SharedStruct : public testing::Test {};

using SharedStructs = testing::Types<
    shared::TextureData, shared::MaterialData, shared::AliasEntry, shared::LightData, shared::LightNode,
    shared::EnvironmentData, shared::InstanceData, shared::GeometryData, shared::PrimitiveData, shared::CsgNodeData,
    shared::CsgTreeData, shared::BoxData, shared::CameraData, shared::RayRecord, shared::RayKinds, shared::Frame,
    shared::FilmBatch, shared::FilmAdd, shared::FilmMean, shared::FilmCoverage, shared::NotFinite, shared::FilmFrame,
    shared::FilmCheck, shared::FilmTile, shared::FixedSum, shared::CoverageSlot, shared::Launch, shared::Instrument,
    shared::InstrumentReport, shared::InstrumentPixel, shared::RecursionGuard, shared::LogHeader, shared::LogRecord,
    shared::HeatPixel, shared::ExplainRay, shared::ExplainRayEnd, shared::ExplainCall, shared::ExplainStage,
    shared::ExplainHit, shared::ExplainBox, shared::ExplainStageEnd, shared::ExplainReport, shared::ExplainStore,
    shared::ExplainCamera, shared::ExplainSurface, shared::ExplainShading, shared::ExplainLobe,
    shared::ExplainLightChoice, shared::ExplainLightSample, shared::ExplainLightRoulette, shared::ExplainVisibility,
    shared::ExplainBsdfSample, shared::ExplainRoulette, shared::ExplainEmission, shared::ExplainContribution,
    shared::ExplainPathEnd, shared::DeformTarget, shared::DeformSkinSet, shared::DeformMatrix, shared::DeformGeometry,
    shared::DeformPass, shared::TreeCostNode, shared::TreeCostGeometry, shared::TreeCostList, shared::TreeCostPass>;

struct StructNames {
  template <class T>
  static std::string GetName(int) {
    return Fields<T>::kName;
  }
};
TYPED_TEST_SUITE(SharedStruct, SharedStructs, StructNames);

TYPED_TEST(SharedStruct, ReachesTheDevice) {
  const TypeParam value = filled<TypeParam>();
  const std::string body = glslFor<TypeParam>() + "#define In " + Fields<TypeParam>::kName + R"(
    #define Out AllWords
    Out run(uint index, In value) { put(value); AllWords result; result.at = words; return result; }
  )";
  const AllWords seen = runCompute<AllWords>(body, std::vector<TypeParam>{value})[0];
  Words expected;
  appendWords(expected, value);
  ASSERT_EQ(expected.size() * 4, sizeof(TypeParam)) << "the members do not fill the struct: padding must be explicit";
  EXPECT_EQ(Words(seen.at, seen.at + expected.size()), expected);
}

TYPED_TEST(SharedStruct, RoundTrips) {
  AllWords source{};
  for (std::size_t i = 0; i < 128; ++i) source.at[i] = pattern(i + 7);
  const std::string body = glslFor<TypeParam>() + "#define Out " + Fields<TypeParam>::kName + R"(
    #define In AllWords
    Out run(uint index, In value) { words = value.at; Out result; take(result); return result; }
  )";
  const TypeParam seen = runCompute<TypeParam>(body, std::vector<AllWords>{source})[0];
  Words words;
  appendWords(words, seen);
  EXPECT_EQ(words, Words(source.at, source.at + words.size()));
}

// A struct that is added to a shared header must be added to this test.
TEST(SharedHeaders, HaveNoUntestedStruct) {
  std::set<std::string> declared;
  std::size_t headers = 0;
  const std::regex structs(R"((?:^|\n)\s*struct\s+(\w+))");
  for (const EmbeddedFile& file : embeddedShaderLibrary()) {
    if (!file.path.starts_with("quintet/shared/")) continue;
    ++headers;
    const std::string text(file.data);
    for (std::sregex_iterator match(text.begin(), text.end(), structs), end; match != end; ++match)
      declared.insert((*match)[1]);
  }
  EXPECT_GE(headers, 6u);
  EXPECT_EQ(declared.erase("Binding"), 1u);  // only C++ has it
  std::set<std::string> tested;
  [&]<class... T>(testing::Types<T...>) { (tested.insert(Fields<T>::kName), ...); }(SharedStructs{});
  EXPECT_EQ(declared, tested);
}

// Constants that are computed from others have the same value in GLSL and C++.
TEST(SharedHeaders, AgreeOnConstants) {
  const auto seen = runCompute<std::array<std::uint32_t, 8>>(R"(
    #include <quintet/shared/albedo.h>
    #include <quintet/shared/film.h>
    struct Out { uint at[8]; };
    Out run(uint index) {
      return Out(uint[8](kAlbedoAverageOffset, kGlassOffset, kAlbedoFloatCount, kNoTexture, kNoLight, kMaxOutputs, kPassColumns,
                         kMaterialTextureOffset));
    }
  )",
                                                             1)[0];
  EXPECT_EQ(seen, (std::array<std::uint32_t, 8>{
                      shared::kAlbedoAverageOffset, shared::kGlassOffset, shared::kAlbedoFloatCount, shared::kNoTexture,
                      shared::kNoLight, shared::kMaxOutputs, shared::kPassColumns, shared::kMaterialTextureOffset}));
}

}  // namespace
}  // namespace quintet::test
