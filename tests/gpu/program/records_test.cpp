// SPDX-License-Identifier: Apache-2.0
// Data of shader records: fields of every type reach every stage, for each hit group and ray type.
#include "run_program.h"

namespace quintet::test {
namespace {

// 12-byte and 4-byte fields in an order that only scalar layout packs without padding.
const std::string kRecordsToml = R"([program]
ray_generation = "main.rgen"
record = { count = -1 }

[[ray]]
name = "first"
miss = "fill.rmiss"
record = { count = -2 }

[[ray]]
name = "second"
miss = "fill.rmiss"

[[miss]]
name = "extra"
file = "fill.rmiss"
record = { count = -3, tint = [7, 8, 9] }

[[callable]]
name = "wood"
file = "fill.rcall"
record = { size = 4000000000 }

[[callable]]
name = "stone"
file = "fill.rcall"
record = { count = -4, mode = "blue" }

[[hit_group]]
name = "a"
material = "a"
record = { weight = 2.5, on = true }
first = { closest_hit = "fill.rchit", any_hit = "touch.rahit", record = { tint = [1, 2, 3] } }
second = { closest_hit = "fill.rchit", any_hit = "touch.rahit", record = { quad = [1, 2, 3, 4], weight = -2.5 } }

[[hit_group]]
name = "b"
material = "b"
first = { closest_hit = "fill.rchit", any_hit = "touch.rahit" }
second = { closest_hit = "fill.rchit", any_hit = "touch.rahit", record = { axis = [0.25, 0.5, 0.75], uv = [5, 6], mode = "green" } }

[[output]]
name = "tint"
[[output]]
name = "numbers"
[[output]]
name = "vectors"
[[output]]
name = "quad"
[[output]]
name = "anyHit"

[[record]]
name = "tint"
type = "color"
default = [0.5, 0.5, 0.5]
[[record]]
name = "on"
type = "bool"
default = false
[[record]]
name = "uv"
type = "vec2"
default = [10, 11]
[[record]]
name = "count"
type = "int"
default = 7
[[record]]
name = "axis"
type = "vec3"
default = [12, 13, 14]
[[record]]
name = "size"
type = "uint"
default = 3
[[record]]
name = "weight"
type = "float"
default = 1
[[record]]
name = "quad"
type = "vec4"
default = [15, 16, 17, 18]
[[record]]
name = "mode"
type = "choice"
choices = ["red", "green", "blue"]
default = "red"
)";

const std::string kFill = R"(
#include <quintet/generated/record.glsl>
#include "data.glsl"
void fill(inout Data data) {
  data.tint = vec4(record.tint, record.weight);
  data.numbers = vec4(record.on, record.count, float(record.size), record.mode == kRecord_mode_blue ? 100u : record.mode);
  data.vectors = vec4(record.uv, record.axis.yz);
  data.quad = record.quad + vec4(0.0, 0.0, 0.0, record.axis.x);
}
)";

const Files kRecordsFiles = {
    {"data.glsl", "struct Data { vec4 tint, numbers, vectors, quad; float anyHit; };\n"},
    {"fill.glsl", kFill},
    {"fill.rchit",
     "#include \"fill.glsl\"\nlayout(location = 0) rayPayloadInEXT Data data;\nvoid main() { fill(data); }\n"},
    {"touch.rahit",
     "#include \"fill.glsl\"\nlayout(location = 0) rayPayloadInEXT Data data;\nvoid main() { data.anyHit = "
     "record.weight; }\n"},
    {"fill.rmiss",
     "#include \"fill.glsl\"\nlayout(location = 0) rayPayloadInEXT Data data;\nvoid main() { fill(data); }\n"},
    {"fill.rcall",
     "#include \"fill.glsl\"\nlayout(location = 0) callableDataInEXT Data data;\nvoid main() { fill(data); }\n"},
    {"main.rgen", R"(#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
#include "fill.glsl"
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadEXT Data data;
layout(location = 0) callableDataEXT Data called;
void main() {
  const uvec2 pixel = launchPixel();
  const uint x = pixel.x;
  data.anyHit = 0.0;
  if (x < 7u) {
    // Squares a and b with both ray types, then rays that miss with three miss shaders.
    const vec3 origin = x < 4u ? vec3(2.0 * float(x / 2u) + 0.25, 0.5, 1.0) : vec3(0.0, 100.0, 0.0);
    const uint ray = x < 4u ? x % 2u : kRay_first;
    const uint miss = x < 4u ? kMiss_first : x == 4u ? kMiss_first : x == 5u ? kMiss_second : kMiss_extra;
    traceRayEXT(topLevelAS, gl_RayFlagsNoOpaqueEXT, 0xFFu, ray, kRayTypeCount, miss, origin, 0.0, vec3(0.0, 0.0, -1.0), 10.0, 0);
  } else if (x < 9u) {
    executeCallableEXT(x == 7u ? kCallable_wood : kCallable_stone, 0);
    data = called;
  } else {
    fill(data);
  }
  storeOutput(kOutput_tint, pixel, data.tint);
  storeOutput(kOutput_numbers, pixel, data.numbers);
  storeOutput(kOutput_vectors, pixel, data.vectors);
  storeOutput(kOutput_quad, pixel, data.quad);
  storeOutput(kOutput_anyHit, pixel, vec4(x < 7u ? data.anyHit : 0.0));
}
)"}};

struct ExpectedRecord {
  const char* what;
  vec4 tint{0.5f, 0.5f, 0.5f, 1};  // tint, weight
  vec4 numbers{0, 7, 3, 0};        // on, count, size, mode
  vec4 vectors{10, 11, 13, 14};    // uv, axis.yz
  vec4 quad{15, 16, 17, 18 + 12};  // quad, + axis.x in w
  float anyHit = 0;
};

TEST(ShaderRecords, ReachEveryStage) {
  const ExpectedRecord kExpected[] = {
      {"a, first", {1, 2, 3, 2.5f}, {1, 7, 3, 0}, {10, 11, 13, 14}, {15, 16, 17, 30}, 2.5f},
      {"a, second", {0.5f, 0.5f, 0.5f, -2.5f}, {1, 7, 3, 0}, {10, 11, 13, 14}, {1, 2, 3, 16}, -2.5f},
      {"b, first", {0.5f, 0.5f, 0.5f, 1}, {0, 7, 3, 0}, {10, 11, 13, 14}, {15, 16, 17, 30}, 1},
      {"b, second", {0.5f, 0.5f, 0.5f, 1}, {0, 7, 3, 1}, {5, 6, 0.5f, 0.75f}, {15, 16, 17, 18.25f}, 1},
      {"miss of first", {0.5f, 0.5f, 0.5f, 1}, {0, -2, 3, 0}},
      {"miss of second"},
      {"additional miss", {7, 8, 9, 1}, {0, -3, 3, 0}},
      {"callable wood", {0.5f, 0.5f, 0.5f, 1}, {0, 7, 4e9f, 0}},
      {"callable stone", {0.5f, 0.5f, 0.5f, 1}, {0, -4, 3, 100}},
      {"ray generation", {0.5f, 0.5f, 0.5f, 1}, {0, -1, 3, 0}},
  };
  const Outputs outputs = runProgram(kRecordsToml, kRecordsFiles, namedSquares({"a", "b"}), 10);
  for (std::size_t i = 0; i < std::size(kExpected); ++i) {
    SCOPED_TRACE(kExpected[i].what);
    EXPECT_EQ(outputs[0][i], kExpected[i].tint);
    EXPECT_EQ(outputs[1][i], kExpected[i].numbers);
    EXPECT_EQ(outputs[2][i], kExpected[i].vectors);
    EXPECT_EQ(outputs[3][i], kExpected[i].quad);
    EXPECT_EQ(outputs[4][i].x, kExpected[i].anyHit);
  }
}

TEST(ShaderRecords, CannotBeIncludedWithoutADeclaration) {
  const std::string toml = "[program]\nray_generation = \"main.rgen\"\n[[ray]]\nname = \"r\"\nmiss = \"m.rmiss\"\n";
  const Files files = {{"main.rgen", "void main() {}\n"},
                       {"m.rmiss", "#include <quintet/generated/record.glsl>\nvoid main() {}\n"}};
  try {
    runProgram(toml, files, namedSquares({"a"}), 1);
    FAIL();
  } catch (const ProgramError& error) {
    EXPECT_NE(std::string(error.what()).find("record"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace quintet::test
