// SPDX-License-Identifier: Apache-2.0
// Modules in the form of other compilers than glslang (tests/check/modules), and GLSL in the style of engines (tests/check/engines):
// correct ones are not reported, mistakes are, with the lines of their sources, and extensions that the check does not follow
// switch rules off.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <spirv-tools/libspirv.hpp>

#include "base/file.h"
#include "check/case_file.h"
#include "check/diagram/diagram.h"
#include "check/diagram/svg.h"
#include "check/modules_test_support.h"
#include "check/reorder_test_support.h"
#include "job/live_module_check.h"
#include "job/module_checks.h"
#include "shader/shader_test_support.h"

namespace quintet::job {
namespace {

namespace fs = std::filesystem;
using shader::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const fs::path kModules = fs::path(QUINTET_SOURCE_ROOT) / "tests/check/modules";

const fs::path kEngines = fs::path(QUINTET_SOURCE_ROOT) / "tests/check/engines";

using Edits = std::vector<std::pair<std::string, std::string>>;

// Assembles a file of tests/check/modules, with replaced text, and checks it with its groups or without.
class ForeignModule {
 public:
  explicit ForeignModule(std::string name, const Edits& edits = {}) : name_(std::move(name)) {
    std::string text = readTextFile(kModules / (name_ + ".spvasm"));
    for (const auto& [from, to] : edits) {
      const std::size_t at = text.find(from);
      EXPECT_NE(at, text.npos) << from;
      if (at != text.npos) text.replace(at, from.size(), to);
    }
    std::string error;
    spvtools::SpirvTools tools(SPV_ENV_UNIVERSAL_1_5);
    tools.SetMessageConsumer([&](spv_message_level_t, const char*, const spv_position_t& at, const char* message) {
      error += std::to_string(at.line + 1) + ": " + message + "\n";
    });
    EXPECT_TRUE(tools.Assemble(text, &words_, SPV_TEXT_TO_BINARY_OPTION_NONE)) << error;
  }

  std::vector<std::uint32_t>& words() { return words_; }

  // Writes the module.
  ModuleCheckRequest request(bool described) const {
    overwrite(*this);
    return {{folder_.path().string()}, described ? kModules / (name_ + ".json") : fs::path(), {}};
  }
  void overwrite(const ForeignModule& other, const std::string& name = {}) const {
    writeFile(folder_.path() / (name.empty() ? name_ + ".spv" : name), std::as_bytes(std::span(other.words_)));
  }

  std::vector<Diagnostic> check(bool described = true) const {
    CheckObserver observer;
    return checkModuleFiles(request(described), observer).diagnostics();
  }

  // "Q104 lib.hlsl:24"; notes by their text.
  std::vector<std::string> found(bool described = true) const {
    std::vector<std::string> result;
    for (const Diagnostic& d : check(described))
      result.push_back(d.id.empty() ? d.text
                                    : d.id + " " + locationText(fs::path(d.file).filename().string(), d.line, 0));
    return result;
  }

 private:
  std::string name_;
  std::vector<std::uint32_t> words_;
  TemporaryFolder folder_;
};

TEST(ForeignModules, CorrectLibrariesOfHlslAndSlangAreNotReported) {
  for (const char* name : {"hlsl_library", "slang_library"})
    for (const bool described : {true, false})
      EXPECT_THAT(ForeignModule(name).found(described), IsEmpty()) << name << described;
}

// The ray generation shader does not clear the payload, and the miss shader leaves a member, although the wrapper that DXC makes
// copies the whole payload back.
const Edits kUnwritten{{"OpStore %g_payload %cleared\n", ""}, {"OpStore %s6 %float_minus\n", ""}};

struct ForeignMistake {
  std::string module;
  Edits edits;
  std::string found;
};

TEST(ForeignModules, MistakesOfHlslAndSlangAreReportedWithTheirLines) {
  const std::vector<ForeignMistake> mistakes{
      {"hlsl_library", kUnwritten, "Q104 lib.hlsl:24"},
      {"hlsl_library",
       {{"%Shadow = OpTypeStruct %float", "%Shadow = OpTypeStruct %float %float"},
        {"%lit_payload = OpVariable %in_shadow", "%lit_payload = OpVariable %in_payload"},
        {"%l_shadow = OpVariable %local_shadow", "%l_shadow = OpVariable %local_payload"},
        {"%l1 = OpLoad %Shadow", "%l1 = OpLoad %Payload"},
        {"%l3 = OpLoad %Shadow", "%l3 = OpLoad %Payload"},
        {"%src_Lit = OpFunction %void None %of_shadow", "%src_Lit = OpFunction %void None %of_payload"},
        {"%l_s = OpFunctionParameter %local_shadow", "%l_s = OpFunctionParameter %local_payload"},
        {"%l5 = OpAccessChain %local_float %l_s %int_0", "%l5 = OpAccessChain %local_float %l_s %int_1"}},
       "Q101 lib.hlsl:26"},
      {"hlsl_library",
       {{"%Attributes = OpTypeStruct %v2float", "%Attributes = OpTypeStruct %v2float %float"}},
       "Q202 hlsl_library.spv#Hit"},
      {"hlsl_library", {{"OpStore %r12 %r11\n", ""}}, "Q205 lib.hlsl:66"},
      {"hlsl_library", {{"OpStore %m7 %m6\n", ""}}, "Q304 lib.hlsl:47"},
      {"hlsl_library", {{"OpExecuteCallableKHR %uint_0", "OpExecuteCallableKHR %uint_1"}}, "Q302 lib.hlsl:47"},
      {"hlsl_library",
       {{"%uint_12 %uint_255 %uint_0 %uint_1 %uint_1 %h10 %float_near",
         "%uint_12 %uint_255 %uint_0 %uint_1 %uint_1 %h10 %float_0"}},
       "Q705 lib.hlsl:44"},
      {"slang_library",
       {{"OpStore %s2 %false\n", ""}, {"OpCompositeConstruct %Payload %black %false", "OpUndef %Payload"}},
       "Q104 lib.slang:5"},
      {"slang_library",
       {{"%SkyPayload = OpTypeStruct %v4float %bool", "%SkyPayload = OpTypeStruct %v3float %bool"}},
       "Q101 lib.slang:5"},
      {"slang_library",
       {{"%uint_255 %uint_0 %uint_1 %uint_0", "%uint_255 %uint_0 %uint_1 %uint_1"}},
       "Q502 lib.slang:5"},
  };
  for (const ForeignMistake& mistake : mistakes)
    EXPECT_THAT(ForeignModule(mistake.module, mistake.edits).found(), testing::Contains(mistake.found))
        << mistake.edits.front().first;
}

// Position fetch, which SPIRV-Tools 2023.1 does not know, and a language that does not exist yet.
TEST(ForeignModules, UnknownCapabilitiesAndDecorationsAreIgnored) {
  const Edits newer{{"OpCapability RayTracingKHR", "OpCapability RayTracingKHR\nOpCapability !5336"},
                    {"OpExtension \"SPV_KHR_ray_tracing\"",
                     "OpExtension \"SPV_KHR_ray_tracing\"\nOpExtension \"SPV_KHR_ray_tracing_position_fetch\""},
                    {"OpSource HLSL 660", "OpSource !77 660"},
                    {"OpDecorate %image Binding 1", "OpDecorate %image Binding 1\nOpDecorate %image !65000"}};
  EXPECT_THAT(ForeignModule("hlsl_library", newer).found(), IsEmpty());
  Edits wrong = newer;
  wrong.insert(wrong.end(), kUnwritten.begin(), kUnwritten.end());
  EXPECT_THAT(ForeignModule("hlsl_library", wrong).found(), ElementsAre("Q104 lib.hlsl:24"));
}

// Passes of SPIRV-Tools 2023.1 leave modules with these extensions unchanged, with all copies of payloads.
TEST(ForeignModules, ExtensionsThatPassesDoNotKnowAreIgnored) {
  for (const char* extension : {"SPV_EXT_shader_atomic_float_add", "SPV_EXT_opacity_micromap", "SPV_KHR_float_controls",
                                "SPV_KHR_maximal_reconvergence"}) {
    const Edits edits{{"OpExtension \"SPV_KHR_ray_tracing\"",
                       "OpExtension \"SPV_KHR_ray_tracing\"\nOpExtension \"" + std::string(extension) + "\""}};
    for (const bool described : {true, false})
      EXPECT_THAT(ForeignModule("hlsl_library", edits).found(described), IsEmpty()) << extension;
  }
}

// An instruction that SPIRV-Tools does not know: a note per entry point of the module, and no report.
TEST(ForeignModules, UnknownInstructionsAreANote) {
  ForeignModule module("hlsl_library");
  std::vector<std::uint32_t>& words = module.words();
  const std::vector<std::uint32_t> unknown{2u << 16 | 60000u, 1};
  // Before OpReturn and OpFunctionEnd of the last function.
  words.insert(words.end() - 2, unknown.begin(), unknown.end());
  for (const bool described : {true, false}) {
    const std::vector<Diagnostic> notes = module.check(described);
    EXPECT_THAT(notes, testing::Not(IsEmpty()));
    for (const Diagnostic& d : notes) {
      EXPECT_EQ(d.severity, Severity::note) << d.text;
      EXPECT_THAT(d.text, HasSubstr("Invalid opcode"));
    }
  }
}

TEST(ForeignModules, TracesOfMotionBlurAreFollowed) {
  const Edits motion{{"OpCapability RayTracingKHR", "OpCapability RayTracingKHR\nOpCapability RayTracingMotionBlurNV"},
                     {"OpExtension \"SPV_KHR_ray_tracing\"",
                      "OpExtension \"SPV_KHR_ray_tracing\"\nOpExtension \"SPV_NV_ray_tracing_motion_blur\""},
                     {"OpTraceRayKHR %g3", "OpTraceRayMotionNV %g3"},
                     {"%forward %float_far %sent", "%forward %float_far %float_half %sent"}};
  EXPECT_THAT(ForeignModule("hlsl_library", motion).found(), IsEmpty());
  Edits wrong = motion;
  wrong.insert(wrong.end(), kUnwritten.begin(), kUnwritten.end());
  EXPECT_THAT(ForeignModule("hlsl_library", wrong).found(), ElementsAre("Q104 lib.hlsl:24"));
}

// Shader invocation reorder of both extensions; in the EXT extension also as one combined instruction.
TEST(ForeignModules, HitObjectsAreFollowed) {
  const Edits reorder{
      {"OpCapability RayTracingKHR", "OpCapability RayTracingKHR\nOpCapability ShaderInvocationReorderNV"},
      {"OpExtension \"SPV_KHR_ray_tracing\"",
       "OpExtension \"SPV_KHR_ray_tracing\"\nOpExtension \"SPV_NV_shader_invocation_reorder\""},
      {"%structure = OpTypeAccelerationStructureKHR",
       "%structure = OpTypeAccelerationStructureKHR\n%object = OpTypeHitObjectNV\n"
       "%local_object = OpTypePointer Function %object"},
      {"%g_payload = OpVariable %local_payload Function",
       "%g_payload = OpVariable %local_payload Function\n%g_object = OpVariable %local_object Function"},
      {"OpTraceRayKHR %g3", "OpHitObjectTraceRayNV %g_object %g3"},
      {"%forward %float_far %sent", "%forward %float_far %sent\nOpHitObjectExecuteShaderNV %g_object %sent"}};
  const auto expectFound = [](const Edits& edits, bool described, const auto& matcher) {
    EXPECT_THAT(ForeignModule("hlsl_library", edits).found(described), matcher);
    for (const bool combines : {false, true}) {
      ForeignModule ext("hlsl_library", edits);
      ext.words() = check::toReorderExt(ext.words(), combines);
      EXPECT_THAT(ext.found(described), matcher) << described << combines;
    }
  };
  for (const bool described : {true, false}) expectFound(reorder, described, IsEmpty());
  Edits wrong = reorder;
  wrong.insert(wrong.end(), kUnwritten.begin(), kUnwritten.end());
  expectFound(wrong, true, ElementsAre("Q104 lib.hlsl:24"));
  wrong = reorder;
  wrong.push_back({"%float_far %shadow", "%float_0 %shadow"});
  expectFound(wrong, true, ElementsAre("Q509 lib.hlsl:44"));
}

// A module of the EXT extension that SPIRV-Tools cannot judge is not called invalid.
TEST(ForeignModules, UnknownInstructionsOfReorderingAreANote) {
  ForeignModule module("hlsl_library");
  std::vector<std::uint32_t>& words = module.words();
  const std::vector<std::uint32_t> capability{2u << 16 | 17u, 5388}, unknown{2u << 16 | 5307u, 1};
  words.insert(words.begin() + 5, capability.begin(), capability.end());
  words.insert(words.end() - 2, unknown.begin(), unknown.end());
  const std::vector<Diagnostic> notes = module.check(true);
  EXPECT_THAT(notes, testing::Not(IsEmpty()));
  for (const Diagnostic& d : notes) EXPECT_EQ(d.severity, Severity::note) << d.text;
}

// A case of tests/check/engines: a pipeline of GLSL files, its groups, and mistakes that are edits of a file.
class EnginePipeline {
 public:
  explicit EnginePipeline(const std::string& name)
      : files_(quintet::test::readCase(kEngines / (name + ".case")).files) {}

  struct Mistake {
    std::string found, file, from, to;
  };
  std::vector<Mistake> mistakes() const {
    std::vector<Mistake> result;
    std::istringstream lines(files_.at("mistakes.txt"));
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with('#')) continue;
      for (std::size_t at = line.find("\\n"); at != line.npos; at = line.find("\\n", at)) line.replace(at, 2, "\n");
      std::istringstream fields(line);
      Mistake& mistake = result.emplace_back();
      for (std::string* field : {&mistake.found, &mistake.file, &mistake.from, &mistake.to})
        std::getline(fields, *field, '\t');
    }
    return result;
  }

  void make(const Mistake& mistake) {
    std::string& text = files_.at(mistake.file);
    const std::size_t at = text.find(mistake.from);
    ASSERT_NE(at, text.npos) << mistake.from;
    text.replace(at, mistake.from.size(), mistake.to);
  }

  // "Q104 a.rgen", with its groups or without. `asExt`: hit objects of the EXT extension.
  std::vector<std::string> found(bool described, bool asExt = false) const {
    std::vector<std::string> result;
    for (const Diagnostic& d : checked(described, asExt, false).diagnostics())
      result.push_back(d.id + " " + fs::path(d.file).filename().string());
    return result;
  }

  std::string svg() const {
    return check::svgText(check::diagramOf(checked(true, false, true).programs.at(0).model.value()));
  }

 private:
  CheckReport checked(bool described, bool asExt, bool describe) const {
    const TemporaryFolder folder;
    const fs::path groups = fs::path(folder.path()) / "pipeline.json";
    for (const auto& [name, text] : files_) {
      const fs::path file = fs::path(folder.path()) / name;
      if (name == "pipeline.json") writeFile(file, text);
      const auto stage = shader::stageOfFile(file);
      if (!stage) continue;
      std::vector<std::uint32_t> words = check::compileRaw(*stage, text, name);
      if (asExt) words = check::toReorderExt(words);
      writeFile(file.string() + ".spv", std::as_bytes(std::span(words)));
    }
    CheckObserver observer;
    ModuleCheckRequest request{{folder.path().string()}, described ? groups : fs::path(), {}};
    request.describe = describe;
    return checkModuleFiles(request, observer);
  }

  std::map<std::string, std::string> files_;
};

class EngineShaders : public testing::TestWithParam<std::string> {};

TEST_P(EngineShaders, AreNotReported) {
  for (const bool described : {true, false}) EXPECT_THAT(EnginePipeline(GetParam()).found(described), IsEmpty());
}

TEST_P(EngineShaders, MistakesAreReportedOnce) {
  const std::vector<EnginePipeline::Mistake> mistakes = EnginePipeline(GetParam()).mistakes();
  EXPECT_THAT(mistakes, testing::Not(IsEmpty()));
  for (const EnginePipeline::Mistake& mistake : mistakes) {
    EnginePipeline pipeline(GetParam());
    pipeline.make(mistake);
    EXPECT_THAT(pipeline.found(true), ElementsAre(mistake.found)) << mistake.file << ": " << mistake.to;
  }
}

// The same pipeline with the cross-vendor extension, and its mistakes of payloads.
TEST(ForeignModules, PathsAreReorderedWithTheExtExtension) {
  const EnginePipeline correct("reordered_paths");
  for (const bool described : {true, false}) EXPECT_THAT(correct.found(described, true), IsEmpty());
  for (const EnginePipeline::Mistake& mistake : correct.mistakes()) {
    if (!mistake.found.starts_with("Q101") && !mistake.found.starts_with("Q104")) continue;
    EnginePipeline pipeline = correct;
    pipeline.make(mistake);
    EXPECT_THAT(pipeline.found(true, true), ElementsAre(mistake.found)) << mistake.file << ": " << mistake.to;
  }
}

std::vector<std::string> engineNames() {
  std::vector<std::string> names;
  for (const fs::path& file : quintet::test::casesIn(kEngines)) names.push_back(file.stem());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Folders, EngineShaders, testing::ValuesIn(engineNames()),
                         [](const auto& name) { return name.param; });

// --graph: the stages, and what each trace can reach.
TEST(ForeignModules, AreDescribedOnRequest) {
  const ForeignModule module("hlsl_library");
  CheckObserver observer;
  ModuleCheckRequest request = module.request(true);
  EXPECT_FALSE(checkModuleFiles(request, observer).programs.at(0).model);
  request.describe = true;
  const CheckReport report = checkModuleFiles(request, observer);
  ASSERT_TRUE(report.programs.at(0).model);
  const check::PipelineModel& model = *report.programs[0].model;
  EXPECT_THAT(model.stages, testing::SizeIs(8));
  ASSERT_THAT(model.hits, testing::SizeIs(2));
  EXPECT_EQ(model.hits[1].group, "balls");
  EXPECT_TRUE(model.hits[1].intersection && !model.hits[1].anyHit);
  ASSERT_THAT(model.traces, testing::SizeIs(3));
  EXPECT_EQ(locationText(model.traces[0].location.file, model.traces[0].location.line, 0), "lib.hlsl:24");
  EXPECT_EQ(model.traces[0].payloadType, "Payload");
  EXPECT_THAT(model.traces[0].targets, testing::SizeIs(3));  // both hit groups and a miss shader
  ASSERT_THAT(model.calls, testing::SizeIs(1));
  EXPECT_THAT(check::svgText(check::diagramOf(model)), HasSubstr("balls"));
}

// A trace with a hit object and its execution are nodes of their own, with the shaders that each runs.
TEST(ForeignModules, HitObjectsAreDrawn) {
  const std::string svg = EnginePipeline("reordered_paths").svg();
  for (const char* text : {"trace paths.rgen", "execution paths.rgen", "not run by this trace"})
    EXPECT_THAT(svg, HasSubstr(text));
}

// --watch: a module that is written again, and a new one in the folder.
TEST(ForeignModules, AreCheckedAgainAfterASave) {
  const ForeignModule correct("hlsl_library"), wrong("hlsl_library", kUnwritten);
  CheckObserver observer;
  LiveModuleCheck live(correct.request(true));
  EXPECT_THAT(live.run(observer).diagnostics(), IsEmpty());
  correct.overwrite(wrong);
  EXPECT_THAT(live.watcher().wait(10.0), testing::SizeIs(1));
  EXPECT_THAT(live.run(observer).diagnostics(), testing::Not(IsEmpty()));
  correct.overwrite(correct, "second.spv");
  EXPECT_THAT(live.watcher().wait(10.0), testing::SizeIs(1));
}

}  // namespace
}  // namespace quintet::job
