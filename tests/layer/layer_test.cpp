// SPDX-License-Identifier: Apache-2.0
// VK_LAYER_QUINTET_link_check on a small application: each mistake is reported exactly once, and the correct application,
// however it creates its pipeline, without a report. Environment: QUINTET_LAYER_FOLDER, the folder of the manifest.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <utility>

#include <vulkan/vulkan.h>

#include "application.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kLayer = "VK_LAYER_QUINTET_link_check";
constexpr const char* kKhronos = "VK_LAYER_KHRONOS_validation";

void replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, text.npos) << from;
  text.replace(at, from.size(), to);
}

struct Mistake {
  std::string name;
  std::string id;  // of the only report
  std::function<void(Application&)> make;
};
void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.name; }

// Replaces text of a shader.
std::function<void(Application&)> edit(const std::string& file, const std::string& from, const std::string& to) {
  return [=](Application& app) { replace(app.shaders.at(file), from, to); };
}

// Replaces main() of the closest-hit shader.
void replaceClosestHit(Application& app, const std::string& text) {
  replace(app.shaders.at("a.rchit"), "void main() { payload = Payload(vec3(weights, 0.25), gl_HitTEXT); }", text);
}

constexpr const char* kBox = R"(hitAttributeEXT vec3 normal;
void main() {
  normal = vec3(0, 0, -1);
  reportIntersectionEXT(4.0, 0u);
}
)";
constexpr const char* kBoxHit = R"(struct Payload { vec3 color; float t; };
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec3 normal;
void main() { payload = Payload(normal, gl_HitTEXT); }
)";

// Boxes with an intersection shader.
void useBoxes(Application& app) {
  app.boxes = true;
  app.shaders["b.rint"] = kBox;
  app.shaders["b.rchit"] = kBoxHit;
  app.hitGroups = {{"b.rchit", "", "b.rint"}};
}

std::function<void(Application&)> editBoxes(const std::string& file, const std::string& from, const std::string& to) {
  return [=](Application& app) {
    useBoxes(app);
    replace(app.shaders.at(file), from, to);
  };
}

// The miss shader calls a callable shader.
void useCallable(Application& app) {
  app.callables = {"a.rcall"};
  app.shaders["a.rcall"] = "layout(location = 0) callableDataInEXT vec3 light;\nvoid main() { light = vec3(1); }\n";
  app.shaders["a.rmiss"] = R"(struct Payload { vec3 color; float t; };
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) callableDataEXT vec3 light;
void main() {
  executeCallableEXT(0, 1);
  payload = Payload(light, -1.0);
}
)";
}

// The closest-hit shader traces a shadow ray.
void useShadow(Application& app) {
  app.depth = 2;
  app.misses = {"a.rmiss", "b.rmiss"};
  app.shaders["b.rmiss"] = "layout(location = 1) rayPayloadInEXT float lit;\nvoid main() { lit = 1.0; }\n";
  app.shaders["a.rchit"] = R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
struct Payload { vec3 color; float t; };
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) rayPayloadEXT float lit;
void main() {
  float t = gl_HitTEXT;
  vec3 p = gl_WorldRayOriginEXT + t * gl_WorldRayDirectionEXT;
  lit = 0.0;
  traceRayEXT(tlas, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFF, 0, 1, 1, p, 0.01,
              vec3(0, 1, 0), 10.0, 1);
  payload = Payload(vec3(lit), t);
}
)";
}

void useAnyHit(Application& app) {
  app.hitGroups[0].anyHit = "a.rahit";
  app.shaders["a.rahit"] =
      "hitAttributeEXT vec2 weights;\nvoid main() { if (weights.x > 0.5) ignoreIntersectionEXT; }\n";
}

// A record of the hit table that no correct application has; it is not traced.
std::function<void(Application&)> editTable(
    std::function<void(std::vector<std::byte>&, std::vector<Application::Region>&)> e) {
  return [e](Application& app) {
    app.editTable = e;
    app.width = 0;
  };
}

// The closest-hit shader reads one of four buffers.
void indexBuffers(Application& app, const std::string& index) {
  app.buffers = 4;
  replaceClosestHit(app, R"(#extension GL_EXT_nonuniform_qualifier : require
layout(shaderRecordEXT, std430) buffer Record { uint kind, slot; } record;
layout(set = 0, binding = 2, std430) buffer Tint { float value; } tints[];
void main() { payload = Payload(vec3(weights, tints[nonuniformEXT()" +
                             index + ")].value), gl_HitTEXT); }");
}

// The second word of the first hit record.
void setRecord(Application& app, std::uint32_t word) {
  app.editTable = [word](std::vector<std::byte>& bytes, std::vector<Application::Region>& regions) {
    std::memcpy(bytes.data() + regions[2].offset + 32 + sizeof word, &word, sizeof word);
  };
}

std::vector<Mistake> mistakes() {
  return {
      {"PayloadTypeOfMiss", "Q101",
       [](Application& app) {
         replace(app.shaders.at("a.rmiss"), "vec3 color; float t;", "vec4 color; float t;");
         replace(app.shaders.at("a.rmiss"), "vec3(0.5)", "vec4(0.5)");
       }},
      {"PayloadOrderOfClosestHit", "Q101",
       [](Application& app) {
         replace(app.shaders.at("a.rchit"), "vec3 color; float t;", "float t; vec3 color;");
         replace(app.shaders.at("a.rchit"), "Payload(vec3(weights, 0.25), gl_HitTEXT)",
                 "Payload(gl_HitTEXT, vec3(weights, 0.25))");
       }},
      {"OutgoingPayloadInMiss", "Q103", edit("a.rmiss", "rayPayloadInEXT", "rayPayloadEXT")},
      {"MissLeavesAMember", "Q104", edit("a.rmiss", "payload = Payload(vec3(0.5), -1.0);", "payload.t = -1.0;")},
      {"ClosestHitLeavesAMemberOnAPath", "Q104",
       edit("a.rchit", "payload = Payload(vec3(weights, 0.25), gl_HitTEXT);",
            "payload.t = gl_HitTEXT; if (weights.x > 0.5) payload.color = vec3(weights, 0.0);")},
      {"NestedTraceOverwritesThePayload", "Q105",
       [](Application& app) {
         app.depth = 2;
         app.shaders["a.rchit"] = R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
struct Payload { vec3 color; float t; };
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 weights;
void main() {
  float t = gl_HitTEXT;
  payload.color = vec3(weights, t);
  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, vec3(50, 50, 0), 0.01, vec3(0, 0, -1), 1.0, 0);
  payload = Payload(payload.color * 0.5, t);
}
)";
       }},
      {"TwoIncomingPayloads", "Q106",
       edit("a.rmiss", "void main() {",
            "layout(location = 1) rayPayloadInEXT vec3 other;\nvoid main() { other = vec3(1.0);")},
      {"PayloadReadBeforeItIsSet", "Q107",
       edit("a.rchit", "payload = Payload(vec3(weights, 0.25), gl_HitTEXT);",
            "payload = Payload(vec3(weights, 0.25) * payload.color.x, gl_HitTEXT);")},
      {"AttributeTypesDiffer", "Q201",
       [](Application& app) {
         useBoxes(app);
         replace(app.shaders.at("b.rchit"), "vec3 normal", "vec4 normal");
         replace(app.shaders.at("b.rchit"), "Payload(normal", "Payload(normal.xyz");
       }},
      {"AttributeOfTriangles", "Q202",
       [](Application& app) {
         replace(app.shaders.at("a.rchit"), "vec2 weights", "vec3 weights");
         replace(app.shaders.at("a.rchit"), "vec3(weights, 0.25)", "weights");
       }},
      {"AttributeIsTooLarge", "Q203",
       [](Application& app) {
         useBoxes(app);
         replace(app.shaders.at("b.rint"), "vec3 normal;", "vec4 normal[3];");
         replace(app.shaders.at("b.rint"), "normal = vec3(0, 0, -1)", "normal = vec4[3](vec4(1), vec4(1), vec4(1))");
         replace(app.shaders.at("b.rchit"), "hitAttributeEXT vec3 normal;\n", "const vec3 normal = vec3(1);\n");
       }},
      {"AttributeIsNotWritten", "Q205", editBoxes("b.rint", "normal = vec3(0, 0, -1);", "")},
      {"IntersectionReportsNothing", "Q206", editBoxes("b.rint", "reportIntersectionEXT(4.0, 0u);", "")},
      {"CallableDataTypesDiffer", "Q301",
       [](Application& app) {
         useCallable(app);
         replace(app.shaders.at("a.rcall"), "vec3 light", "vec4 light");
         replace(app.shaders.at("a.rcall"), "vec3(1)", "vec4(1)");
       }},
      {"CallWithoutCallableShaders", "Q302",
       [](Application& app) {
         useCallable(app);
         app.callables.clear();
         app.width = 0;
       }},
      {"CallableDataIsNotWritten", "Q304",
       [](Application& app) {
         useCallable(app);
         replace(app.shaders.at("a.rcall"), "light = vec3(1);", "");
       }},
      {"RecursionIsDeeperThanDeclared", "Q402",
       [](Application& app) {
         useShadow(app);
         app.depth = 1;
         app.width = 0;
       }},
      {"OffsetExceedsItsBits", "Q503", edit("a.rgen", "0xFF, 0, 1, 0,", "0xFF, 16, 1, 0,")},
      {"MissIndexExceedsItsBits", "Q504", edit("a.rgen", "0xFF, 0, 1, 0,", "0xFF, 0, 1, 65536,")},
      {"MaskExceedsItsBits", "Q505", edit("a.rgen", "0xFF, 0, 1, 0,", "0x1FF, 0, 1, 0,")},
      {"MaskIsZero", "Q507", edit("a.rgen", "0xFF, 0, 1, 0,", "0x00, 0, 1, 0,")},
      {"FlagsAndMaskAreSwapped", "Q508", edit("a.rgen", "gl_RayFlagsNoneEXT, 0xFF,", "0xFF, gl_RayFlagsNoneEXT,")},
      {"IntervalIsEmpty", "Q509", edit("a.rgen", "0.001, direction, 100.0", "100.0, direction, 0.001")},
      {"DirectionIsZero", "Q510",
       [](Application& app) {
         replace(app.shaders.at("a.rgen"), "vec3(0, 0, 1);", "vec3(0);");
         app.width = 0;
       }},
      {"FirstHitIsShaded", "Q512", edit("a.rgen", "gl_RayFlagsNoneEXT", "gl_RayFlagsTerminateOnFirstHitEXT")},
      {"FlagsSkipAllGeometry", "Q513", edit("a.rgen", "gl_RayFlagsNoneEXT", "0x100u")},
      {"FlagsExcludeEachOther", "Q605",
       edit("a.rgen", "gl_RayFlagsNoneEXT",
            "gl_RayFlagsCullBackFacingTrianglesEXT | gl_RayFlagsCullFrontFacingTrianglesEXT")},
      {"AnyHitIgnoresEverything", "Q606",
       [](Application& app) {
         useAnyHit(app);
         replace(app.shaders.at("a.rahit"), "if (weights.x > 0.5) ", "");
       }},
      {"HitKindIsReserved", "Q608", editBoxes("b.rint", "4.0, 0u", "4.0, 200u")},
      {"FlagsExcludeTheAnyHitShader", "Q610",
       [](Application& app) {
         useAnyHit(app);
         replace(app.shaders.at("a.rgen"), "gl_RayFlagsNoneEXT", "gl_RayFlagsOpaqueEXT");
       }},
      {"DistanceOfANormalizedDirection", "Q701",
       [](Application& app) {
         useBoxes(app);
         app.shaders["b.rint"] = R"(hitAttributeEXT vec3 normal;
void main() {
  vec3 d = normalize(gl_ObjectRayDirectionEXT), o = gl_ObjectRayOriginEXT;
  float t = -dot(o - vec3(0, 0, 5), d) / dot(d, d);
  normal = vec3(0, 0, -1);
  reportIntersectionEXT(t, 0u);
}
)";
       }},
      {"ShadowRayWithoutAnOffset", "Q705",
       [](Application& app) {
         useShadow(app);
         replace(app.shaders.at("a.rchit"), "p, 0.01,", "p, 0.0,");
       }},
      {"IndexBeyondAnArray", "Q711",
       edit("a.rmiss", "void main() { payload = Payload(vec3(0.5), -1.0); }",
            "layout(set = 0, binding = 1, std430) buffer R { float at[4]; } r;\n"
            "void main() { float s = 0.0; for (int i = 0; i <= 4; ++i) s += r.at[i];\n"
            "payload = Payload(vec3(s), -1.0); }")},
      {"IntegerDivisionOfTheLaunchId", "Q716",
       edit("a.rgen", "(vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 0.5",
            "vec2(gl_LaunchIDEXT.xy / gl_LaunchSizeEXT.xy) - 0.5")},
      {"UnreachableCallable", "Q801",
       [](Application& app) {
         useCallable(app);
         app.shaders["a.rmiss"] = correctApplication().shaders.at("a.rmiss");
       }},
      // Only the table shows these (sbt=1).
      {"MissIndexBeyondTheTable", "Q502",
       [](Application& app) {
         replace(app.shaders.at("a.rgen"), "0xFF, 0, 1, 0,", "0xFF, 0, 1, 2,");
         app.misses = {"a.rmiss", "c.rmiss"};
         app.shaders["c.rmiss"] = app.shaders.at("a.rmiss");
         app.width = 0;
       }},
      {"HitRecordBeyondTheTable", "Q515",
       [](Application& app) {
         app.recordOffset = 3;
         app.width = 0;
       }},
      {"CustomIndexBeyondAnArray", "Q711",
       [](Application& app) {
         replaceClosestHit(app,
                           "const vec3 kTints[2] = vec3[](vec3(0.1), vec3(0.2));\n"
                           "void main() { payload = Payload(kTints[gl_InstanceCustomIndexEXT], gl_HitTEXT); }");
         app.customIndex = 2;
         app.width = 0;
       }},
      {"CustomIndexBeyondDescriptors", "Q711",
       [](Application& app) {
         indexBuffers(app, "gl_InstanceCustomIndexEXT");
         app.customIndex = 4;
         app.width = 0;
       }},
      {"CustomIndexBeyondTheBoundSet", "Q711",
       [](Application& app) {
         indexBuffers(app, "gl_InstanceCustomIndexEXT");
         app.customIndex = 2;
         app.setBuffers = 2;
         app.width = 0;
       }},
      {"RecordIndexBeyondDescriptors", "Q711",
       [](Application& app) {
         indexBuffers(app, "record.slot");
         setRecord(app, 4);
         app.width = 0;
       }},
      {"TrianglesUseAProceduralGroup", "Q609",
       [](Application& app) {
         useBoxes(app);
         app.boxes = false;
         app.width = 0;
       }},
      {"HandleOfADifferentPipeline", "Q661",
       editTable([](auto& bytes, auto& regions) { std::memset(bytes.data() + regions[2].offset, 0x5A, 32); })},
      {"MissHandleInTheHitRegion", "Q662",
       [](Application& app) {
         app.hitRecords = {1};
         app.width = 0;
       }},
      {"NullRayGeneration", "Q663",
       editTable([](auto& bytes, auto& regions) { std::memset(bytes.data() + regions[0].offset, 0, 64); })},
      {"StrideIsNotAligned", "Q664", editTable([](auto&, auto& regions) { regions[1].stride = 40; })},
      {"RegionBeyondItsBuffer", "Q665", editTable([](auto&, auto& regions) {
         regions[3] = {3072, 64, 64 * 64};
       })},
      {"RecordBlockDoesNotFit", "Q666",
       [](Application& app) {
         replaceClosestHit(app,
                           "layout(shaderRecordEXT, std430) buffer Record { vec4 a, b, tint; } record;\n"
                           "void main() { payload = Payload(record.tint.xyz + vec3(weights, 0), gl_HitTEXT); }");
         app.width = 0;
       }},
      {"StackIsTooSmall", "Q667",
       [](Application& app) {
         useShadow(app);
         app.stack = 0;
         app.width = 0;
       }},
  };
}

Application withLayer(std::vector<std::string> layers = {kLayer}) {
  Application app = correctApplication();
  app.layers = std::move(layers);
  return app;
}

std::vector<std::string> idsOf(const RunResult& run) {
  std::vector<std::string> ids;
  for (const Message& message : run.messages) ids.push_back(message.id);
  return ids;
}

std::string textsOf(const RunResult& run) {
  std::string all;
  for (const Message& message : run.messages) all += message.text + "\n";
  return all;
}

class LayerMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(LayerMistakes, AreReportedExactlyOnce) {
  Application app = withLayer();
  GetParam().make(app);
  const RunResult result = runApplication(app);
  EXPECT_EQ(result.error, "");
  EXPECT_THAT(idsOf(result), ElementsAre(GetParam().id)) << textsOf(result);
  EXPECT_THAT(result.messages, Contains(Field(&Message::object, "main")));
}

INSTANTIATE_TEST_SUITE_P(Layer, LayerMistakes, testing::ValuesIn(mistakes()),
                         [](const auto& tested) { return tested.param.name; });

class LayerCorrect : public testing::TestWithParam<std::string> {};

// The application without a mistake, and the same with each feature that the mistakes use.
TEST_P(LayerCorrect, IsNotReported) {
  Application app = withLayer();
  const std::string& feature = GetParam();
  if (feature == "Boxes") useBoxes(app);
  if (feature == "Callable") useCallable(app);
  if (feature == "Shadow") useShadow(app);
  if (feature == "AnyHit") useAnyHit(app);
  if (feature == "Inlined") app.modules = Modules::inlined;
  if (feature == "Library") app.modules = Modules::library;
  if (feature == "Flags2") app.modules = Modules::flags2;
  if (feature == "Deferred") app.modules = Modules::deferred;
  if (feature == "Indirect") app.trace = Trace::indirect;
  if (feature == "Indirect2") app.trace = Trace::indirect2;
  if (feature == "Opaque") app.opaque = true;
  if (feature == "NoDebugInfo") app.debugInfo = false;
  if (feature == "Stack") app.stack = 1u << 13;  // NVIDIA loses the device with 64 KiB
  if (feature == "Descriptors") {
    indexBuffers(app, "record.slot");
    setRecord(app, 3);
  }
  if (feature == "DescriptorsOfTheSet") {
    indexBuffers(app, "gl_InstanceCustomIndexEXT");
    app.customIndex = 1;
    app.setBuffers = 2;
  }
  if (feature == "GuardedRecord") {
    indexBuffers(app, "record.slot");
    setRecord(app, 0xFFFFFFFF);
    replace(app.shaders.at("a.rchit"), "payload = Payload(",
            "payload = Payload(vec3(0), 1.0);\n  if (record.slot < 4u) payload = Payload(");
  }
  if (feature == "OtherGeneration") {  // with tables of its own
    app.otherGenerations = {"b.rgen"};
    app.shaders["b.rgen"] = app.shaders.at("a.rgen");
    replace(app.shaders.at("b.rgen"), "0xFF, 0, 1, 0,", "0xFF, 3, 1, 5,");
  }
  if (feature == "Constants") {
    replace(app.shaders.at("a.rgen"), "void main() {", "layout(constant_id = 0) const uint kMiss = 7u;\nvoid main() {");
    replace(app.shaders.at("a.rgen"), "0xFF, 0, 1, 0,", "0xFF, 0, 1, kMiss,");
    app.constants = {{0, 0}};
  }
  const RunResult result = runApplication(app);
  EXPECT_EQ(result.error, "");
  EXPECT_THAT(result.messages, IsEmpty()) << textsOf(result);
  // The layer does not change the result.
  app.layers.clear();
  EXPECT_EQ(runApplication(app).pixels, result.pixels);
}

INSTANTIATE_TEST_SUITE_P(Layer, LayerCorrect,
                         testing::Values("Triangles", "Boxes", "Callable", "Shadow", "AnyHit", "Inlined", "Library",
                                         "Flags2", "Deferred", "Indirect", "Indirect2", "Opaque", "NoDebugInfo",
                                         "Stack", "Constants", "Descriptors", "DescriptorsOfTheSet", "GuardedRecord",
                                         "OtherGeneration"),
                         [](const auto& tested) { return tested.param; });

class LayerCreation : public testing::TestWithParam<Modules> {};

TEST_P(LayerCreation, FindsMistakesHoweverThePipelineIsCreated) {
  Application app = withLayer();
  app.modules = GetParam();
  replace(app.shaders.at("a.rchit"), "payload = Payload(vec3(weights, 0.25), gl_HitTEXT);", "payload.t = gl_HitTEXT;");
  const RunResult result = runApplication(app);
  EXPECT_EQ(result.error, "");
  EXPECT_THAT(idsOf(result), ElementsAre("Q104"));
  EXPECT_THAT(textsOf(result), AllOf(HasSubstr("a.rgen:10"), HasSubstr("payload.color")));
}

INSTANTIATE_TEST_SUITE_P(Layer, LayerCreation,
                         testing::Values(Modules::handles, Modules::inlined, Modules::library, Modules::deferred,
                                         Modules::flags2));

class LayerTraces : public testing::TestWithParam<Trace> {};

// The regions of an indirect trace can be in device memory.
TEST_P(LayerTraces, ChecksTheTableOfEachCommand) {
  const auto idsWith = [](const std::function<void(Application&)>& make) {
    Application app = withLayer();
    make(app);
    app.trace = GetParam();
    app.width = 0;
    const RunResult result = runApplication(app);
    EXPECT_EQ(result.error, "");
    return idsOf(result);
  };
  EXPECT_THAT(idsWith([](Application&) {}), IsEmpty());
  EXPECT_THAT(idsWith([](Application& app) { app.recordOffset = 3; }), ElementsAre("Q515"));
  EXPECT_THAT(idsWith([](Application& app) { app.hitRecords = {1}; }), ElementsAre("Q662"));
  EXPECT_THAT(idsWith(editTable([](auto&, auto& regions) { regions[1].stride = 40; })), ElementsAre("Q664"));
  EXPECT_THAT(idsWith(editTable([](auto&, auto& regions) { regions[3] = {3072, 64, 64 * 64}; })), ElementsAre("Q665"));
}

INSTANTIATE_TEST_SUITE_P(Layer, LayerTraces, testing::Values(Trace::direct, Trace::indirect, Trace::indirect2));

// Functions that lavapipe does not have, by a layer below the link check.
class LayerHostDriver : public testing::Test {
 protected:
  void SetUp() override {
    folders_ = std::getenv("VK_ADD_LAYER_PATH");
    ::setenv("VK_ADD_LAYER_PATH", (folders_ + ":" QUINTET_HOST_DRIVER_FOLDER).c_str(), 1);
  }
  void TearDown() override { ::setenv("VK_ADD_LAYER_PATH", folders_.c_str(), 1); }
  static Application application() { return withLayer({kLayer, "VK_LAYER_QUINTET_host_driver"}); }

 private:
  std::string folders_;
};

TEST_F(LayerHostDriver, FollowsBuildsOnTheHost) {
  Application app = application();
  app.hostBuilds = true;
  app.width = 0;
  RunResult result = runApplication(app);
  EXPECT_EQ(result.error, "");
  EXPECT_THAT(result.messages, IsEmpty()) << textsOf(result);
  app.recordOffset = 2;
  EXPECT_THAT(idsOf(runApplication(app)), ElementsAre("Q515"));
  app.recordOffset = 0;
  app.boxes = true;  // with a hit group of triangles
  EXPECT_THAT(idsOf(runApplication(app)), ElementsAre("Q609"));
}

TEST_F(LayerHostDriver, FindsTheModulesOfIdentifiers) {
  Application app = application();
  app.modules = Modules::identifiers;
  RunResult result = runApplication(app);
  EXPECT_EQ(result.error, "");
  EXPECT_THAT(result.messages, IsEmpty()) << textsOf(result);
  replace(app.shaders.at("a.rmiss"), "payload = Payload(vec3(0.5), -1.0);", "payload.t = -1.0;");
  EXPECT_THAT(idsOf(runApplication(app)), ElementsAre("Q104"));
}

TEST_F(LayerHostDriver, FollowsHitObjects) {
  Application app = application();
  app.width = 0;
  std::string& text = app.shaders.at("a.rgen");
  text.insert(0, "#extension GL_NV_shader_invocation_reorder : require\n");
  replace(text, "traceRayEXT(tlas,", "hitObjectNV hit;\n  hitObjectTraceRayNV(hit, tlas,");
  replace(text, "100.0, 0);", "100.0, 0);\n  reorderThreadNV(hit);\n  hitObjectExecuteShaderNV(hit, 0);");
  RunResult result = runApplication(app);
  EXPECT_EQ(result.error, "");
  EXPECT_THAT(result.messages, IsEmpty()) << textsOf(result);
  app.recordOffset = 2;
  EXPECT_THAT(idsOf(runApplication(app)), ElementsAre("Q515"));
  app.recordOffset = 0;
  Application leaves = app;
  replace(leaves.shaders.at("a.rmiss"), "payload = Payload(vec3(0.5), -1.0);", "payload.t = -1.0;");
  result = runApplication(leaves);
  EXPECT_THAT(idsOf(result), ElementsAre("Q104"));
  EXPECT_THAT(textsOf(result), HasSubstr("read after this execution of a hit object"));
  replace(app.shaders.at("a.rmiss"), "vec3 color; float t;", "vec4 color; float t;");
  replace(app.shaders.at("a.rmiss"), "vec3(0.5)", "vec4(0.5)");
  EXPECT_THAT(idsOf(runApplication(app)), ElementsAre("Q101"));
}

TEST(Layer, AppliesSpecializationConstants) {
  Application app = withLayer();
  replace(app.shaders.at("a.rgen"), "void main() {", "layout(constant_id = 0) const uint kMask = 255u;\nvoid main() {");
  replace(app.shaders.at("a.rgen"), "0xFF, 0, 1, 0,", "kMask, 0, 1, 0,");
  app.constants = {{0, 0}};
  EXPECT_THAT(idsOf(runApplication(app)), ElementsAre("Q507"));
}

// Devices can be destroyed when the process exits, after the objects of libraries, if the driver supports that.
TEST(Layer, WorksWhileStaticObjectsAreDestroyed) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  Application app = withLayer({});
  app.exit = Exit::destroysLate;
  bool supported = true;
  const auto noteStatus = [&](int status) {
    supported = status == 0;
    return supported || WIFSIGNALED(status);
  };
  EXPECT_EXIT(runApplication(app), noteStatus, "");
  if (!supported) GTEST_SKIP() << "the driver crashes without the layer, too";
  app.layers = {kLayer};
  EXPECT_EXIT(runApplication(app), testing::ExitedWithCode(0), "");
}

// Engines create a stage for each hit group, from few modules. What they share is checked, and reported, once.
TEST(Layer, ChecksRepeatedStagesOnce) {
  Application app = withLayer();
  app.hitCopies = 12;
  app.hitRecords = {2};
  RunResult result = runApplication(app);
  EXPECT_EQ(result.error, "");
  EXPECT_THAT(result.messages, IsEmpty()) << textsOf(result);
  replace(app.shaders.at("a.rchit"), "payload = Payload(vec3(weights, 0.25), gl_HitTEXT);", "payload.t = weights.x;");
  app.hitRecords = {13};  // the last copy
  result = runApplication(app);
  EXPECT_THAT(idsOf(result), ElementsAre("Q104")) << textsOf(result);
}

// Ray generation in SPIR-V assembly, without names and lines.
TEST(Layer, NamesTheIdOfHandwrittenSpirv) {
  Application app = withLayer();
  app.misses = {"m.rmiss.spvasm"};
  app.shaders["m.rmiss.spvasm"] = R"(OpCapability RayTracingKHR
OpExtension "SPV_KHR_ray_tracing"
OpMemoryModel Logical GLSL450
OpEntryPoint MissKHR %main "main" %in
%void = OpTypeVoid
%signature = OpTypeFunction %void
%float = OpTypeFloat 32
%v2 = OpTypeVector %float 2
%pointer = OpTypePointer IncomingRayPayloadKHR %v2
%in = OpVariable %pointer IncomingRayPayloadKHR
%zero = OpConstant %float 0
%value = OpConstantComposite %v2 %zero %zero
%main = OpFunction %void None %signature
%entry = OpLabel
OpStore %in %value
OpReturn
OpFunctionEnd
)";
  app.debugInfo = false;
  const RunResult result = runApplication(app);
  EXPECT_EQ(result.error, "");
  EXPECT_THAT(idsOf(result), ElementsAre("Q101"));
  EXPECT_THAT(textsOf(result), AllOf(HasSubstr("SPIR-V id %"), HasSubstr("OpTraceRayKHR number 1")));
}

// Settings of the layer for one test. A folder for its files.
class LayerSettings : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "quintet-layer-XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    if (const char* value = std::getenv("QUINTET_LINK_CHECK")) before_ = value;
  }
  void TearDown() override {
    ::setenv("QUINTET_LINK_CHECK", before_.c_str(), 1);
    std::filesystem::remove_all(folder_);
  }
  static void set(const std::string& settings) { ::setenv("QUINTET_LINK_CHECK", settings.c_str(), 1); }
  std::filesystem::path file(const std::string& name) const { return folder_ / name; }
  std::string textOf(const std::string& name) const {
    std::ifstream stream(file(name));
    return {std::istreambuf_iterator<char>(stream), {}};
  }

 private:
  std::filesystem::path folder_;
  std::string before_;
};

Application withMistake() {
  Application app = withLayer();
  replace(app.shaders.at("a.rmiss"), "payload = Payload(vec3(0.5), -1.0);", "payload.t = -1.0;");
  return app;
}

// Each pipeline has the mistake, which is reported once.
TEST_F(LayerSettings, CountsRepeatedMistakesOfThreads) {
  set("output=" + file("link.txt").string());
  Application app = withMistake();
  app.pipelines = 8;
  const RunResult result = runApplication(app);
  EXPECT_EQ(result.error, "");
  EXPECT_THAT(idsOf(result), ElementsAre("Q104"));
  EXPECT_THAT(textOf("link.txt"), AllOf(HasSubstr("a.rgen:10:3: warning:"), HasSubstr("payload.color"),
                                        HasSubstr("a.rgen:10: Q104 occurred 8 times")));
}

TEST_F(LayerSettings, WritesSarif) {
  set("output=" + file("link.sarif").string());
  EXPECT_THAT(idsOf(runApplication(withMistake())), ElementsAre("Q104"));
  EXPECT_THAT(textOf("link.sarif"), AllOf(HasSubstr("\"version\":\"2.1.0\""), HasSubstr("\"ruleId\":\"Q104\""),
                                          HasSubstr("\"uri\":\"a.rgen\""), HasSubstr("\"startLine\":10"),
                                          HasSubstr("\"executionSuccessful\":true")));
}

TEST_F(LayerSettings, AppliesTheSuppressionFile) {
  std::ofstream(file("accepted.txt")) << "Q104 a.rgen:10  # on purpose\n";
  set("suppressions=" + file("accepted.txt").string() + ",output=" + file("link.sarif").string());
  EXPECT_THAT(runApplication(withMistake()).messages, IsEmpty());
  EXPECT_THAT(textOf("link.sarif"), AllOf(HasSubstr("on purpose"), HasSubstr("\"kind\":\"external\"")));
  std::ofstream(file("accepted.txt")) << "Q104 a.rgen:11\n";
  EXPECT_THAT(idsOf(runApplication(withMistake())), ElementsAre("Q104"));
}

// Applications can exit while the layer checks a pipeline. The reports are complete then.
TEST_F(LayerSettings, FinishesReportsOfAnApplicationThatExits) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  // The child process runs the test, too, with a folder of its own.
  constexpr const char* kOutput = "QUINTET_LAYER_TEST_OUTPUT";
  ::setenv(kOutput, file("link.sarif").c_str(), 0);
  set(std::string("output=") + std::getenv(kOutput));
  EXPECT_EXIT(
      {
        Application app = withMistake();
        app.exit = Exit::withoutDestroying;
        runApplication(app);
      },
      testing::ExitedWithCode(0), "");
  ::unsetenv(kOutput);
  EXPECT_THAT(textOf("link.sarif"), AllOf(HasSubstr("\"executionSuccessful\":true"), HasSubstr("Q104")));
}

// Above and below the validation layers: neither layer disturbs the other.
TEST(Layer, WorksWithTheValidationLayers) {
  for (const std::vector<std::string>& layers :
       {std::vector<std::string>{kLayer, kKhronos}, std::vector<std::string>{kKhronos, kLayer}}) {
    Application app = withLayer(layers);
    RunResult result = runApplication(app);
    EXPECT_EQ(result.error, "");
    EXPECT_THAT(result.messages, IsEmpty()) << textsOf(result);
    EXPECT_THAT(result.others, IsEmpty());
    replace(app.shaders.at("a.rmiss"), "payload = Payload(vec3(0.5), -1.0);", "payload.t = -1.0;");
    result = runApplication(app);
    EXPECT_THAT(idsOf(result), ElementsAre("Q104"));
    EXPECT_THAT(result.others, IsEmpty());
  }
}

// Prints the table of docs/layer.md: mistake, what the validation layers report, what the link check reports.
TEST(LayerComparison, DISABLED_PrintsTheTable) {
  for (const Mistake& mistake : mistakes()) {
    Application app = withLayer({kKhronos, kLayer});
    mistake.make(app);
    const RunResult result = runApplication(app);
    std::string others;
    for (const std::string& other : result.others) {
      const std::string id = other.substr(0, other.find(':'));
      if (others.find(id) == others.npos) others += (others.empty() ? "" : ", ") + id;
    }
    std::cout << "| " << mistake.name << " | " << (others.empty() ? "–" : others) << " | " << mistake.id << " |\n";
  }
}

double medianOf(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// The cost of the layer, from pairs of runs without and with it, so that other load on the machine affects both. CPU times are
// those of the calling thread, which other processes hardly change. Run it with QUINTET_LINK_CHECK=sbt=0. A pair is about 0.2 s.
TEST(LayerCost, DISABLED_PrintsTimes) {
  constexpr int kPairs = 40;
  struct Times {
    std::vector<double> wall, cpu, first, trace, record;
  } times[2];
  std::vector<double> creation, trace;  // relative costs of each pair
  double shortest = 1e9;                // of a trace
  for (int i = 0; i < kPairs; ++i) {
    RunResult runs[2];
    for (const int k : {i % 2, 1 - i % 2}) {
      Application app = withLayer(k ? std::vector<std::string>{kLayer} : std::vector<std::string>{});
      useShadow(app);
      app.submissions = 501;
      app.width = 64;
      runs[k] = runApplication(app);
      ASSERT_EQ(runs[k].error, "");
      const double traces = app.submissions - 1;
      times[k].wall.push_back(runs[k].creationSeconds);
      times[k].cpu.push_back(runs[k].creationCpuSeconds);
      times[k].first.push_back(runs[k].firstSeconds);
      times[k].trace.push_back(runs[k].traceSeconds / traces);
      times[k].record.push_back(runs[k].recordCpuSeconds / traces);
      shortest = std::min(shortest, runs[k].traceSeconds / traces);
    }
    creation.push_back(runs[1].creationCpuSeconds / runs[0].creationCpuSeconds - 1.0);
    trace.push_back((runs[1].recordCpuSeconds - runs[0].recordCpuSeconds) / 500.0);
  }
  for (const int k : {0, 1})
    std::cout << (k ? "with the layer: " : "without:        ") << "creation " << medianOf(times[k].wall) * 1e3
              << " ms (CPU " << medianOf(times[k].cpu) * 1e3 << " ms), first trace " << medianOf(times[k].first) * 1e3
              << " ms, trace " << medianOf(times[k].trace) * 1e6 << " us (recording and submission: CPU "
              << medianOf(times[k].record) * 1e6 << " us)\n";
  std::cout << "medians of " << kPairs << " pairs: pipeline creation " << medianOf(creation) * 100.0
            << " % CPU time, trace " << medianOf(trace) * 1e6 << " us CPU time, " << medianOf(trace) / shortest * 100.0
            << " % of the shortest trace\n";
}

// The same for pipelines with many hit groups, each with a stage of its own. The application ends after the creation.
TEST(LayerCost, DISABLED_PrintsTimesOfManyHitGroups) {
  for (const std::uint32_t count : {250u, 1000u, 4000u}) {
    std::vector<double> cpu[2], wall[2], relative;
    for (int i = 0; i < 10; ++i) {
      for (const int k : {i % 2, 1 - i % 2}) {
        Application app = withLayer(k ? std::vector<std::string>{kLayer} : std::vector<std::string>{});
        app.hitCopies = count;
        app.submissions = 0;
        const RunResult run = runApplication(app);
        ASSERT_EQ(run.error, "");
        cpu[k].push_back(run.creationCpuSeconds);
        wall[k].push_back(run.creationSeconds);
      }
      relative.push_back(cpu[1].back() / cpu[0].back() - 1.0);
    }
    std::cout << count << " hit groups: creation CPU " << medianOf(cpu[0]) << " s without, " << medianOf(cpu[1])
              << " s with the layer (" << medianOf(relative) * 100.0 << " %), wall clock " << medianOf(wall[0]) << ", "
              << medianOf(wall[1]) << " s" << std::endl;
  }
}

// The texts of Application::hitVariants: 16 shaders that differ in their code. 1373527789 is kVariantMark.
void addVariantTexts(Application& app) {
  for (std::uint32_t k = 0; k < Application::kVariantTexts; ++k) {
    std::string text = R"(struct Payload { vec3 color; float t; };
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 weights;
float hash(uint seed) { seed = seed * 747796405u + 2891336453u; return float(seed >> 8) * (1.0 / 16777216.0); }
void main() {
  vec3 color = vec3(hash(uint(gl_PrimitiveID) + 1373527789u), weights);
)";
    for (std::uint32_t line = 0; line < 4 + 2 * k; ++line)
      text += "  if (weights.x > " + std::to_string(0.01 * (line + 1)) + ") color = mix(color, color.yzx, hash(" +
              std::to_string(line * 7 + k) + "u));\n";
    text += "  payload = Payload(color * dot(gl_WorldRayDirectionEXT, vec3(0, 0, 1)), gl_HitTEXT);\n}\n";
    app.shaders["v" + std::to_string(k) + ".rchit"] = std::move(text);
  }
}

TEST(Layer, ChecksEachOfManyModules) {
  Application app = withLayer();
  addVariantTexts(app);
  app.hitVariants = 24;
  app.submissions = 0;
  replace(app.shaders.at("v5.rchit"), "vec2 weights", "vec3 weights");
  replace(app.shaders.at("v5.rchit"), "1373527789u), weights)", "1373527789u), weights.xy)");
  const RunResult result = runApplication(app);
  EXPECT_EQ(result.error, "");
  // Of the stages 7 and 23.
  EXPECT_THAT(idsOf(result), ElementsAre("Q202", "Q202")) << textsOf(result);
}

// The cost of pipelines with many different modules: creation without and with the layer, and once with wait=1, where it includes
// the check. VARIANTS sets the number of modules, PAIRS that of pairs.
TEST(LayerCost, DISABLED_PrintsTimesOfManyModules) {
  const auto number = [](const char* name, int other) {
    const char* given = std::getenv(name);
    return given ? std::atoi(given) : other;
  };
  std::vector<double> cpu[2], wall[2], relative;
  const auto run = [&](bool layer) {
    Application app = withLayer(layer ? std::vector<std::string>{kLayer} : std::vector<std::string>{});
    addVariantTexts(app);
    app.hitVariants = static_cast<std::uint32_t>(number("VARIANTS", 2000));
    app.submissions = 0;
    const RunResult result = runApplication(app);
    EXPECT_EQ(result.error, "");
    EXPECT_THAT(result.messages, IsEmpty()) << textsOf(result).substr(0, 500);
    return result;
  };
  const char* settings = std::getenv("QUINTET_LINK_CHECK");
  const std::string before = settings ? settings : "";
  const RunResult plain = run(false);
  ::setenv("QUINTET_LINK_CHECK", "wait=1", 1);
  const RunResult waited = run(true);
  const double megabytes = (static_cast<double>(waited.residentBytes) - static_cast<double>(plain.residentBytes)) / 1e6;
  std::cout << "with wait=1: " << waited.creationSeconds << " s instead of " << plain.creationSeconds << " s, "
            << megabytes << " MB more" << std::endl;
  ::setenv("QUINTET_LINK_CHECK", before.c_str(), 1);
  for (int i = 0; i < number("PAIRS", 5); ++i) {
    for (const int k : {i % 2, 1 - i % 2}) {
      const RunResult result = run(k == 1);
      cpu[k].push_back(result.creationCpuSeconds);
      wall[k].push_back(result.creationSeconds);
    }
    relative.push_back(cpu[1].back() / cpu[0].back() - 1.0);
  }
  if (relative.empty()) return;
  std::cout << "creation CPU " << medianOf(cpu[0]) << " s without, " << medianOf(cpu[1]) << " s with the layer ("
            << medianOf(relative) * 100.0 << " %), wall clock " << medianOf(wall[0]) << ", " << medianOf(wall[1])
            << " s" << std::endl;
}

// Keeps the driver's library loaded: NVIDIA's cannot be loaded any number of times in a process (static TLS).
struct LoadedDriver : testing::Environment {
  VkInstance instance = VK_NULL_HANDLE;
  void SetUp() override {
    const VkInstanceCreateInfo info{
        VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, nullptr, 0, nullptr, 0, nullptr, 0, nullptr};
    vkCreateInstance(&info, nullptr, &instance);
  }
  void TearDown() override { vkDestroyInstance(instance, nullptr); }
};

}  // namespace
}  // namespace quintet::test

int main(int count, char** arguments) {
  ::setenv("VK_ADD_LAYER_PATH", QUINTET_LAYER_FOLDER, 0);
  ::setenv("QUINTET_LINK_CHECK", "sbt=1", 0);
  ::setenv("GALLIUM_OVERRIDE_CPU_CAPS", "avx", 0);  // docs/design/quirks.md
  testing::InitGoogleMock(&count, arguments);
  testing::AddGlobalTestEnvironment(new quintet::test::LoadedDriver);
  return RUN_ALL_TESTS();
}
