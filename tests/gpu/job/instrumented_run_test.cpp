// SPDX-License-Identifier: Apache-2.0
// `check --instrument` for a requested size, region, number of samples and parameters.
#include "job/instrumented_run.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "job/scene_source.h"
#include "job/test_engine.h"
#include "program/lecture/lecture.h"

namespace quintet::job {
namespace {

// Traces a ray that is not finite in column 200 of frame `badFrame`.
program::Program programWithBadColumn() {
  return program::parseLecture(
      "struct RayPayloadType { vec3 color; };\nuniform int badFrame; // defaultval=\"1\"\n"
      "void main() { /**** RAY GENERATION SHADER ****/ vec3 d = vec3(0.0, 0.0, -1.0); payload.color = vec3(0.0);\n"
      "  if (gl_LaunchIDEXT.x == 200u && frameID == badFrame) d.y = sqrt(d.z - float(gl_LaunchIDEXT.x));\n"
      "  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 9.0), 0.0, d, 100.0, 0);\n"
      "  gsnSetPixel(vec4(payload.color, 1.0)); }\n"
      "void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }\n"
      "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(1.0); }\n",
      "demo.rt.glsl", "here");
}

std::string idsFor(const RenderRequest& request) {
  const program::Program program = programWithBadColumn();
  std::string ids;
  for (const Diagnostic& d :
       runInstrumented(testEngine(), program, loadScene(chooseSceneSource({}, program)), request, {}))
    ids += d.id + ":" + std::to_string(d.line) + " ";
  return ids;
}

TEST(InstrumentedRun, RendersTheRequestedSizeAndRegion) {
  RenderRequest request;
  EXPECT_EQ(idsFor(request), "") << "96x64 by default";
  request.size = {256, 8};
  EXPECT_EQ(idsFor(request), "Q001:5 ");
  request.region = {0, 0, 100, 8};
  EXPECT_EQ(idsFor(request), "");
  request.region = {195, 4, 10, 2};
  EXPECT_EQ(idsFor(request), "Q001:5 ");
  request.region = {250, 0, 10, 8};
  EXPECT_THROW(idsFor(request), UsageError);
}

// Of a launch of 8x4 pixels.
std::vector<Diagnostic> findingsOf(const std::string& lecture) {
  const program::Program program = program::parseLecture(lecture, "demo.rt.glsl", "here");
  RenderRequest request;
  request.size = {8, 4};
  return runInstrumented(testEngine(), program, loadScene(chooseSceneSource({}, program)), request, {});
}

// Not the line of the store.
TEST(InstrumentedRun, NamesTheLineThatMadeAValueNotFinite) {
  const std::vector<Diagnostic> found = findingsOf(
      "float half_(float x) { return 0.5 * x; }\n"
      "void main() { /**** RAY GENERATION SHADER ****/\n"
      "  float x = float(gl_LaunchIDEXT.x) - 3.0, y = float(2u * gl_LaunchIDEXT.x) - 6.0;\n"  // x / x may become 1
      "  float ratio = x\n"
      "    / y;\n"
      "  vec3 color = vec3(half_(ratio));\n"
      "  gsnSetPixel(vec4(color, 1.0)); }\n");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].id, "Q002");
  EXPECT_EQ(found[0].file, "here/demo.rt.glsl");
  EXPECT_GE(found[0].line, 4);
  EXPECT_LE(found[0].line, 5);
  EXPECT_EQ(found[0].text.find("the result of this division is NaN; output '"), 0u) << found[0].text;
  EXPECT_NE(found[0].text.find("4 such pixels"), std::string::npos) << found[0].text;
}

// Operations that pass a NaN on are not its origin, whichever of their operands it is. The library makes this one: ∞ / ∞.
TEST(InstrumentedRun, DoesNotNameOperationsThatPassAValueOn) {
  const std::vector<Diagnostic> found = findingsOf(
      "#include <quintet/scattering.glsl>\n"
      "void main() { /**** RAY GENERATION SHADER ****/\n"
      "  float value = phaseFunction(0.5, 1e30 + float(gl_LaunchIDEXT.x));\n"
      "  gsnSetPixel(vec4(0.5 * value, value * 0.5, 1.0 - value, value / 3.0)); }\n");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].id, "Q002");
  EXPECT_NE(found[0].file.find("quintet/scattering.glsl"), std::string::npos)
      << found[0].file << ":" << found[0].line << ": " << found[0].text;
}

TEST(InstrumentedRun, RendersTheRequestedFramesAndParameters) {
  RenderRequest request;
  request.size = {256, 8};
  request.limits.samples = 1;
  EXPECT_EQ(idsFor(request), "");
  request.assignments = {"badFrame=6"};
  request.limits.samples = 6;
  EXPECT_EQ(idsFor(request), "");
  request.limits.samples = 7;
  EXPECT_EQ(idsFor(request), "Q001:5 ");
  request.assignments = {"badFram=6"};
  EXPECT_THROW(idsFor(request), UsageError);
}

}  // namespace
}  // namespace quintet::job
