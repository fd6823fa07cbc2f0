// SPDX-License-Identifier: Apache-2.0
// Checks at run time: each mistake is reported at its line, and correct programs give no reports.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "harness.h"
#include "job/device_limits.h"
#include "job/runnable_program.h"
#include "job/scene_source.h"
#include "program/description/parser.h"
#include "program/lecture/lecture.h"
#include "program/load.h"
#include "render/rendered_image.h"
#include "scene/defaults/auto_camera.h"
#include "scene/defaults/default_environment.h"

namespace quintet::test {
namespace {

const std::string kCommon = "struct RayPayloadType { vec3 color; int level; };\n";
const std::string kMiss = "void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }\n";
const std::string kHit = "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(1.0); }\n";

// Lines: 1 common, 2 ray generation.
std::string instrumentedRayGeneration(const std::string& body) {
  return "void main() { /**** RAY GENERATION SHADER ****/ vec2 p = (vec2(gl_LaunchIDEXT.xy) + 0.5) / "
         "vec2(gl_LaunchSizeEXT.xy); "
         "vec3 eye = vec3(0.0, 1.0, 6.0); vec3 d = normalize(vec3(p - 0.5, -1.0)); payload.color = vec3(0.0); " +
         body + " gsnSetPixel(vec4(payload.color, 1.0)); }\n";
}
std::string trace(const std::string& origin, const std::string& direction, const std::string& miss = "0u") {
  return "traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, " + miss + ", " + origin + ", 0.0, " + direction + ", 100.0, 0);";
}

std::vector<Diagnostic> notesOf(const program::Program& program, const scene::Scene& scene, std::uint32_t size = 16) {
  render::DeviceScene deviceScene(testContext(), scene::Scene(scene), scene::effectiveEnvironment(scene));
  render::RenderSettings settings;
  settings.width = settings.height = size;
  settings.camera = scene.cameras.empty() ? scene::frameScene(scene::worldBounds(scene), 1.0f) : scene.cameras.front();
  settings.instrument = true;
  render::Renderer renderer = makeRenderer(deviceScene, program, settings);
  renderer.renderBatch(1);
  return renderer.runtimeDiagnostics();
}

std::vector<Diagnostic> notesOf(const std::string& text) {
  const program::Program program = program::parseLecture(text, "demo.rt.glsl", "here");
  return notesOf(program, job::loadScene(job::chooseSceneSource({}, program)));
}

std::string idsOf(const std::vector<Diagnostic>& notes) {
  std::string ids;
  for (const Diagnostic& d : notes) ids += (ids.empty() ? "" : " ") + d.id + ":" + std::to_string(d.line);
  return ids;
}

TEST(Instrument, ReportsNothingForACorrectProgram) {
  EXPECT_EQ(idsOf(notesOf(kCommon + instrumentedRayGeneration(trace("eye", "d")) + kHit + kMiss)), "");
}

TEST(Instrument, ReportsNothingForBuiltInPrograms) {
  for (const char* name :
       {"pathtracer", "ao", "lessons/07_mirror_recursion", "lessons/10_sphere", "lessons/17_records"}) {
    const program::Program program = program::loadProgram(name);
    std::vector<Diagnostic> notes = notesOf(program, job::loadScene(job::chooseSceneSource({}, program)), 12);
    std::erase_if(notes, [](const Diagnostic& d) { return d.severity == Severity::note; });
    EXPECT_EQ(idsOf(notes), "") << name << (notes.empty() ? "" : ": " + notes.front().text);
  }
}

// Nested traces and callable shaders run as without the checks.
TEST(Instrument, KeepsTheImageOfLessons) {
  for (const char* name : {"lessons/07_mirror_recursion", "lessons/16_callable"}) {
    const program::Program program = program::loadProgram(name);
    const scene::Scene scene = job::loadScene(job::chooseSceneSource({}, program));
    render::DeviceScene device(testContext(), scene::Scene(scene), scene::effectiveEnvironment(scene));
    render::RenderSettings settings;
    settings.width = settings.height = 16;
    settings.parameters = program::ParameterValues(program.parameters);
    const auto render = [&](bool instrument) {
      settings.instrument = instrument;
      render::Renderer renderer = makeRenderer(device, program, settings);
      renderer.renderBatch(1);
      return renderer.image();
    };
    const auto checked = render(true), plain = render(false);
    // The compilers of GPUs contract other expressions of other code.
    float worst = 0.0f;
    for (std::uint32_t y = 0; y < settings.height; ++y)
      for (std::uint32_t x = 0; x < settings.width; ++x)
        for (std::size_t c = 0; c < 4; ++c)
          worst = std::max(worst, std::abs(checked.pixel<float>(x, y)[c] - plain.pixel<float>(x, y)[c]));
    EXPECT_LE(worst, testContext().info().software ? 0.0f : 1e-4f) << name;
  }
}

TEST(Instrument, ReportsRaysThatAreNotFinite) {
  const auto notes = notesOf(
      kCommon + instrumentedRayGeneration("if (gl_LaunchIDEXT.x == 3u) d.y = sqrt(-p.x);\n" + trace("eye", "d")) +
      kHit + kMiss);
  EXPECT_EQ(idsOf(notes), "Q001:3");
  EXPECT_EQ(notes[0].severity, Severity::error);
  EXPECT_NE(notes[0].text.find("pixel 3, "), std::string::npos) << notes[0].text;
  EXPECT_NE(notes[0].text.find("16 such"), std::string::npos) << notes[0].text;
}

// A trace in an included file, in a line that the program also has.
TEST(Instrument, ReportsTheFileOfATraceInAnIncludedFile) {
  const std::string text = kCommon + "void side() { vec2 unused = vec2(0.0); }\n#include \"far.glsl\"\n" +
                           instrumentedRayGeneration("far(eye, float(gl_LaunchIDEXT.x & 1u) * d);") + kHit + kMiss;
  const std::string far = "void far(vec3 o, vec3 d) {\n" + trace("o", "d") + " }\n";
  const program::Program program = program::parseLecture(text, "demo.rt.glsl", "here", {{"far.glsl", far}});
  const auto notes = notesOf(program, job::loadScene(job::chooseSceneSource({}, program)));
  EXPECT_EQ(idsOf(notes), "Q001:2");
  ASSERT_FALSE(notes.empty());
  EXPECT_EQ(notes[0].file, "here/far.glsl");
}

TEST(Instrument, ReportsRaysWithoutDirection) {
  const auto notes =
      notesOf(kCommon + instrumentedRayGeneration(trace("eye", "float(gl_LaunchIDEXT.x & 1u) * d")) + kHit + kMiss);
  EXPECT_EQ(idsOf(notes), "Q001:2");
  ASSERT_FALSE(notes.empty());
  EXPECT_NE(notes[0].text.find("its direction is 0: "), std::string::npos) << notes[0].text;
  EXPECT_NE(notes[0].text.find("t in [0, 100]"), std::string::npos) << notes[0].text;
}

// The offset is not a constant, so only the run finds that the table has no such record.
TEST(Instrument, ReportsHitRecordsOutOfRange) {
  const auto notes = notesOf(
      kCommon + "uniform int which; // defaultval=\"7\"\n" +
      instrumentedRayGeneration("\ntraceRayEXT(topLevelAS, 0u, 0xFFu, uint(which), 1u, 0u, eye, 0.0, d, 100.0, 0);") +
      kHit + kMiss);
  EXPECT_EQ(idsOf(notes), "Q004:4");
  ASSERT_FALSE(notes.empty());
  EXPECT_NE(notes[0].text.find("with offset 7 and stride 1"), std::string::npos) << notes[0].text;
}

TEST(Instrument, ReportsOutputsThatAreNotFinite) {
  const auto notes = notesOf(
      kCommon +
      instrumentedRayGeneration(
          trace("eye", "d") +
          " if (gl_LaunchIDEXT.y == 4u) payload.color = vec3(uintBitsToFloat(0x7FC00000u + gl_LaunchIDEXT.x));") +
      kHit + kMiss);
  EXPECT_EQ(idsOf(notes), "Q002:0");
}

TEST(Instrument, ReportsRecursionBeyondTheDeclaredDepth) {
  const std::string options = "// gsnShaderOptions: precompiler=\"GL_EXT_ray_tracing, recursion: 3\"\n";
  const std::string hit =
      "void main() { /**** CLOSEST-HIT SHADER ****/ vec3 o = gl_WorldRayOriginEXT; vec3 d = "
      "gl_WorldRayDirectionEXT;\nif (gl_HitTEXT > 0.0) { " +
      trace("o", "d") + " } payload.color = vec3(0.1); }\n";
  EXPECT_EQ(idsOf(notesOf(options + kCommon + instrumentedRayGeneration(trace("eye", "d")) + hit + kMiss)), "Q003:5");
}

TEST(Instrument, ReportsMissIndicesOutOfRange) {
  const auto notes =
      notesOf(kCommon + "uniform int which; // defaultval=\"7\"\n" +
              instrumentedRayGeneration(trace("eye", "d + vec3(0.0, 9.0, 0.0)", "uint(which)")) + kHit + kMiss);
  EXPECT_EQ(idsOf(notes), "Q004:3");
  ASSERT_FALSE(notes.empty());
  EXPECT_NE(notes[0].text.find("beyond the 1 miss shader of the table"), std::string::npos) << notes[0].text;
}

TEST(Instrument, ReportsCallableIndicesOutOfRange) {
  const std::string callable =
      "struct CallableDataType { vec3 value; };\nvoid main() { /**** CALLABLE SHADER ****/ callableData.value *= 0.5; "
      "}\n";
  const std::string call = " callableData.value = vec3(1.0);\nexecuteCallableEXT(gl_LaunchIDEXT.x / 15u * 9u, 0);";
  const auto notes = notesOf(kCommon + callable + instrumentedRayGeneration(trace("eye", "d") + call) + kHit + kMiss);
  EXPECT_EQ(idsOf(notes), "Q004:5");
  EXPECT_NE(notes.at(0).text.find("callable index 9"), std::string::npos) << notes[0].text;
  EXPECT_NE(notes.at(0).text.find("16 such calls"), std::string::npos) << notes[0].text;
}

// A folder with a ray generation shader only.
program::Program storing(const std::string& statement) {
  return program::parseProgram(
      "[program]\nray_generation = \"main.rgen\"\n[[ray]]\nname = \"primary\"\nmiss = "
      "\"sky.rmiss\"\n[[output]]\nname = \"color\"\n",
      "demo", "here",
      {{"main.rgen",
        "#version 460\n#extension GL_EXT_ray_tracing : require\n#include <quintet/output.glsl>\n"
        "#include <quintet/generated/program.glsl>\nvoid main() {\n" +
            statement + "\n}\n"},
       {"sky.rmiss", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {}\n"}});
}

TEST(Instrument, ReportsOutputsOutsideOfTheImage) {
  const scene::Scene scene = job::loadScene(job::chooseSceneSource({}, storing("")));
  const auto notes = notesOf(storing("storeOutput(kOutput_color, launchPixel() + uvec2(1, 0), vec4(1.0));"), scene);
  EXPECT_EQ(idsOf(notes), "Q007:6");
  EXPECT_NE(notes.at(0).text.find("16, "), std::string::npos) << notes[0].text;
  EXPECT_NE(notes.at(0).text.find("16 such stores"), std::string::npos) << notes[0].text;
  EXPECT_EQ(idsOf(notesOf(storing("addOutput(77u, launchPixel(), vec4(1.0));"), scene)), "Q007:6");
  EXPECT_EQ(idsOf(notesOf(storing("addOutput(1u, launchPixel(), vec4(1.0));"), scene)), "Q007:6");
  EXPECT_EQ(idsOf(notesOf(storing("addOutput(kOutput_color, launchPixel(), vec4(1.0));"), scene)), "");
}

// Without instrumentation they are ignored: no other pixel changes.
TEST(Outputs, IgnorePixelsOutsideOfTheImage) {
  const program::Program program = storing(
      "storeOutput(kOutput_color, launchPixel() * 100000u + 7000u, vec4(1.0));\n"
      "storeOutput(kOutput_color, uvec2(16u, gl_LaunchIDEXT.y), vec4(1.0));\n"
      "storeOutput(kOutput_color, uvec2(gl_LaunchIDEXT.x, 16u), vec4(1.0));\n"
      "storeOutput(1u + gl_LaunchIDEXT.x * 40u, launchPixel(), vec4(1.0));\n"
      "addOutput(kOutput_color, launchPixel() - uvec2(1000), vec4(1.0));\n"
      "storeCoverage(kOutput_color, uvec2(0xFFFFFFFFu), 3u, 1u);\n"
      "countRays(uvec2(0x7FFFFFFFu), 1u, 0u);\n"
      "if (loadOutput(kOutput_color, uvec2(1u << 30)) != vec4(0.0)) storeOutput(kOutput_color, uvec2(0), vec4(1.0));");
  const scene::Scene scene = job::loadScene(job::chooseSceneSource({}, program));
  render::DeviceScene deviceScene(testContext(), scene::Scene(scene), scene::effectiveEnvironment(scene));
  render::RenderSettings settings;
  settings.width = settings.height = 16;
  render::Renderer renderer = makeRenderer(deviceScene, program, settings);
  renderer.renderBatch(1);
  const io::Image image = renderer.image();
  for (const float value : image.samples<float>()) EXPECT_EQ(value, 0.0f);
  EXPECT_EQ(renderer.rays().rays, 0u);
}

// Each hit traces the same ray again, with the declared recursion `depth`. The condition always holds, which the check does
// not know.
program::Program endlessRecursion(int depth) {
  const std::string options =
      "// gsnShaderOptions: precompiler=\"GL_EXT_ray_tracing, recursion: " + std::to_string(depth) + "\"\n";
  const std::string hit =
      "void main() { /**** CLOSEST-HIT SHADER ****/ payload.level++; vec3 o = gl_WorldRayOriginEXT; vec3 d = "
      "gl_WorldRayDirectionEXT;\nif (gl_HitTEXT > 0.0) { " +
      trace("o", "d") + " } payload.color = vec3(0.001 * payload.level); }\n";
  return program::parseLecture(
      options + kCommon + instrumentedRayGeneration(" payload.level = 0; " + trace("eye", "d")) + hit + kMiss,
      "demo.rt.glsl", "here");
}

// Every run skips the traces that are too deep, and counts them.
TEST(Recursion, EndsAtTheDepthOfThePipeline) {
  for (const int depth : {3, 31}) {
    const program::Program program = endlessRecursion(depth);
    const scene::Scene scene = job::loadScene(job::chooseSceneSource({}, program));
    render::DeviceScene deviceScene(testContext(), scene::Scene(scene), scene::effectiveEnvironment(scene));
    render::RenderSettings settings;
    settings.width = 24;
    settings.height = 16;
    settings.region = {4, 2, 16, 12};
    settings.camera =
        scene.cameras.empty() ? scene::frameScene(scene::worldBounds(scene), 1.0f) : scene.cameras.front();
    render::Renderer renderer = makeRenderer(deviceScene, program, settings);
    renderer.renderBatch(1);
    float deepest = 0;
    std::uint64_t hits = 0;
    const io::Image image = renderer.image();
    const std::span<const float> values = image.samples<float>();
    for (std::size_t i = 0; i < values.size(); i += 4) {
      deepest = std::max(deepest, values[i]);
      hits += values[i] > 0.0f ? 1 : 0;
    }
    EXPECT_NEAR(deepest, 0.001f * static_cast<float>(depth) / 12.92f, 1e-6f);  // display values are decoded
    EXPECT_GT(hits, 0u);
    EXPECT_EQ(renderer.skippedTraces(), hits);
    renderer.restart();
    EXPECT_EQ(renderer.skippedTraces(), 0u);
  }
}

// `frame` and `parameters` are macros, as are the calls whose arguments they are.
TEST(Recursion, IsCountedIfArgumentsAreParameters) {
  const std::string head =
      "#version 460\n#extension GL_EXT_ray_tracing : require\n#include <quintet/output.glsl>\n#include "
      "<quintet/generated/program.glsl>\nlayout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT "
      "tlas;\n";
  const std::string payload = "layout(location = 0) rayPayloadInEXT float level;\nvoid main() { ";
  const std::string trace = "traceRayEXT(tlas, 0u, 0xFFu, kRay_r, kRayTypeCount, kMiss_r, ";
  const program::Program program = program::parseProgram(
      "[program]\nray_generation = \"main.rgen\"\nmax_recursion = 2\n[[ray]]\nname = \"r\"\nmiss = "
      "\"sky.rmiss\"\n[[hit_group]]\nname = \"all\"\nr = { closest_hit = \"hit.rchit\" }\n[[parameter]]\nname = "
      "\"bias\"\ntype = \"float\"\ndefault = 0.001\n[[output]]\nname = \"color\"\n",
      "demo", "here",
      {{"main.rgen", head + "layout(location = 0) rayPayloadEXT float level;\nvoid main() { level = 0.0; " + trace +
                         "vec3(0.0, 1.0, 6.0), parameters.bias, frame.width * vec3(0.0, -1.0, -6.0), 100.0, 0); "
                         "storeOutput(kOutput_color, uvec2(launchPixel().x, frame.height - 1u), "
                         "vec4(level + parameters.bias)); }\n"},
       {"hit.rchit",
        head + payload + "level += 1.0; if (level < 2.0) " + trace +
            "gl_WorldRayOriginEXT, parameters.bias, gl_WorldRayDirectionEXT * frame.width, 100.0, 0); }\n"},
       {"sky.rmiss", head + payload + "}\n"}});
  const scene::Scene scene = job::loadScene(job::chooseSceneSource({}, program));
  render::DeviceScene deviceScene(testContext(), scene::Scene(scene), scene::effectiveEnvironment(scene));
  for (const bool instrument : {false, true}) {
    render::RenderSettings settings;
    settings.width = settings.height = 8;
    settings.instrument = instrument;
    settings.parameters = program::ParameterValues(program.parameters);
    render::Renderer renderer = makeRenderer(deviceScene, program, settings);
    renderer.renderBatch(1);
    EXPECT_NEAR(renderer.image().samples<float>().back(), 2.001f, 1e-5f) << instrument;
    EXPECT_EQ(renderer.skippedTraces(), 0u);
  }
}

TEST(Recursion, IsNotCountedWithoutACycle) {
  const program::Program program = program::loadProgram("pathtracer");
  const scene::Scene scene = job::loadScene(job::chooseSceneSource({}, program));
  render::DeviceScene deviceScene(testContext(), scene::Scene(scene), scene::effectiveEnvironment(scene));
  const job::CheckedProgram checked =
      job::compileAndCheck(program, testCompiler(), render::renderDefines(deviceScene.defines(), {}),
                           deviceScene.facts(), job::deviceLimits(testContext().info()));
  EXPECT_FALSE(checked.runnable.countsRecursion);
}

TEST(Instrument, ReportsSelfIntersections) {
  // The second ray starts just in front of the surface and hits it again.
  const std::string hit =
      "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = gl_WorldRayOriginEXT + gl_HitTEXT * "
      "gl_WorldRayDirectionEXT; payload.level = 1; }\n";
  const std::string miss = "void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); payload.level = 0; }\n";
  const auto notes = notesOf(
      kCommon +
      instrumentedRayGeneration(trace("eye", "d") + " if (payload.level == 1) { vec3 o = payload.color - 1e-7 * d;\n" +
                                trace("o", "d") + " }") +
      hit + miss);
  EXPECT_EQ(idsOf(notes), "Q005:3");
}

const std::string kPositionHit =
    "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = gl_WorldRayOriginEXT + gl_HitTEXT * "
    "gl_WorldRayDirectionEXT; payload.level = 1; ";
const std::string kLevelMiss =
    "void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); payload.level = 0; }\n";
std::string shadowTrace(const std::string& origin, const std::string& tmin) {
  return "traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, "
         "0u, "
         "0u, " +
         origin + ", " + tmin + ", d, 100.0, 0);";
}

// No shader of the program runs at the hit of the shadow ray.
TEST(Instrument, ReportsSelfIntersectionsOfRaysThatSkipClosestHitShaders) {
  const auto idsFor = [](const std::string& tmin) {
    return idsOf(notesOf(kCommon +
                         instrumentedRayGeneration(trace("eye", "d") +
                                                   " if (payload.level == 1) { vec3 o = payload.color - 1e-7 * d;\n\n" +
                                                   shadowTrace("o", tmin) + " }") +
                         kPositionHit + "}\n" + kLevelMiss));
  };
  EXPECT_EQ(idsFor("0.0"), "Q005:4");
  EXPECT_EQ(idsFor("1e-3"), "");
}

// The nested ray ends elsewhere. The shadow ray starts on the hit of the shader that traces it.
TEST(Instrument, ReportsSelfIntersectionsAfterANestedTrace) {
  const auto idsFor = [](const std::string& tmin) {
    return idsOf(
        notesOf("// gsnShaderOptions: precompiler=\"GL_EXT_ray_tracing, recursion: 2\"\n" + kCommon +
                instrumentedRayGeneration("payload.level = 0; " + trace("eye", "d")) + kPositionHit +
                "vec3 d = gl_WorldRayDirectionEXT, o = payload.color - 1e-7 * d;\nif (gl_WorldRayOriginEXT.z == 6.0) { "
                "traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, o, 1e-3, d, 100.0, 0);\nif (payload.level == 1) " +
                shadowTrace("o", tmin) + " } }\n" + kLevelMiss));
  };
  EXPECT_EQ(idsFor("0.0"), "Q005:6");
  EXPECT_EQ(idsFor("1e-3"), "");
}

// A shadow ray type without a closest-hit shader, and with a payload of its own.
program::Program shadowRays(const std::string& flags, const std::string& tmin) {
  const std::string head = "#version 460\n#extension GL_EXT_ray_tracing : require\n";
  return program::parseProgram(
      "[program]\nray_generation = \"main.rgen\"\n[[ray]]\nname = \"radiance\"\nmiss = \"sky.rmiss\"\n[[ray]]\nname = "
      "\"shadow\"\nmiss = \"lit.rmiss\"\n[[hit_group]]\nname = \"all\"\nradiance = { closest_hit = "
      "\"hit.rchit\" }\n[[output]]\nname = \"color\"\n",
      "demo", "here",
      {{"main.rgen", head + R"(
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT tlas;
layout(location = 0) rayPayloadEXT vec4 radiance;
layout(location = 1) rayPayloadEXT float light;
void main() {
  const uvec2 pixel = launchPixel();
  const vec2 p = (vec2(pixel) + 0.5) / vec2(frame.width, frame.height);
  const vec3 d = normalize(vec3(p - 0.5, -1.0));
  traceRayEXT(tlas, 0u, 0xFFu, kRay_radiance, kRayTypeCount, kMiss_radiance, vec3(0.0, 1.0, 6.0), 0.0, d, 100.0, 0);
  light = 0.0;
  if (radiance.w == 1.0)
    traceRayEXT(tlas, )" +
                         flags + R"(, 0xFFu, kRay_shadow, kRayTypeCount, kMiss_shadow, radiance.xyz - 1e-7 * d, )" +
                         tmin +
                         R"(, d, 100.0, 1);
  storeOutput(kOutput_color, pixel, vec4(light));
}
)"},
       {"hit.rchit", head + "layout(location = 0) rayPayloadInEXT vec4 radiance;\nvoid main() { radiance = "
                            "vec4(gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT, 1.0); }\n"},
       {"sky.rmiss",
        head + "layout(location = 0) rayPayloadInEXT vec4 radiance;\nvoid main() { radiance = vec4(0.0); }\n"},
       {"lit.rmiss", head + "layout(location = 1) rayPayloadInEXT float light;\nvoid main() { light = 1.0; }\n"}});
}

TEST(Instrument, ReportsSelfIntersectionsOfRayTypesWithoutClosestHitShaders) {
  const scene::Scene scene = job::loadScene(job::chooseSceneSource({}, storing("")));
  for (const char* flags : {"gl_RayFlagsSkipClosestHitShaderEXT", "gl_RayFlagsTerminateOnFirstHitEXT"}) {
    EXPECT_EQ(idsOf(notesOf(shadowRays(flags, "0.0"), scene)), "Q005:16") << flags;
    EXPECT_EQ(idsOf(notesOf(shadowRays(flags, "1e-3"), scene)), "") << flags;
  }
}

// The shaders read the flags of the ray that the program traces.
TEST(Instrument, KeepsTheImage) {
  const std::string skips = "(gl_IncomingRayFlagsEXT & gl_RayFlagsSkipClosestHitShaderEXT) != 0u";
  const program::Program program = program::parseLecture(
      kCommon +
          instrumentedRayGeneration(trace("eye", "d") + " payload.level = 2; " + shadowTrace("eye", "0.0") +
                                    " payload.color.y = 0.1 * payload.level; payload.level = 2; " +
                                    shadowTrace("eye + vec3(0.0, 99.0, 0.0)", "0.0") +
                                    " payload.color.z = 0.1 * payload.level;") +
          "void main() { /**** ANY-HIT SHADER ****/ if (" + skips + " && gl_HitTEXT < 5.5) ignoreIntersectionEXT; }\n" +
          kHit + "void main() { /**** MISS SHADER ****/ payload.level = " + skips + " ? 5 : 7; }\n",
      "demo.rt.glsl", "here");
  const scene::Scene scene = job::loadScene(job::chooseSceneSource({}, program));
  render::DeviceScene deviceScene(testContext(), scene::Scene(scene), scene::effectiveEnvironment(scene));
  std::vector<io::Image> images;
  for (const bool instrument : {false, true}) {
    render::RenderSettings settings;
    settings.width = settings.height = 24;
    settings.instrument = instrument;
    render::Renderer renderer = makeRenderer(deviceScene, program, settings);
    renderer.renderBatch(1);
    images.push_back(renderer.image());
  }
  const std::span<const float> plain = images[0].samples<float>(), checked = images[1].samples<float>();
  EXPECT_TRUE(std::ranges::equal(plain, checked));
  EXPECT_GT(std::set<float>(plain.begin(), plain.end()).size(), 3u);
}

TEST(Instrument, CountsAnyHitCalls) {
  const std::string anyHit =
      "void main() { /**** ANY-HIT SHADER ****/ if (gl_HitTEXT < 3.0) ignoreIntersectionEXT; }\n";
  const auto notes = notesOf(kCommon + instrumentedRayGeneration(trace("eye", "d")) + anyHit + kHit + kMiss);
  EXPECT_EQ(idsOf(notes), "Q006:0");
  EXPECT_NE(notes[0].text.find("for 256 traces"), std::string::npos) << notes[0].text;
}

}  // namespace
}  // namespace quintet::test
