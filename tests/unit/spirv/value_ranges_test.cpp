// SPDX-License-Identifier: Apache-2.0
// Ranges of values: of the argument of a store to a payload member in small shaders.
#include "spirv/value_ranges.h"

#include <random>

#include "shader/shader_test_support.h"

namespace quintet::spirv {
using namespace shader;

namespace {

// Two lines precede the text. `out.x`, `out.i`, … are what the tests look at.
constexpr const char* kRangeHead = R"(#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
struct Data { float x; int i; uint u; };
layout(location = 0) rayPayloadInEXT Data data;
struct Parameters { float bias; uint mode; vec3 tint; };
layout(push_constant, scalar) uniform Block { Parameters parameters; };
const float kTable[4] = float[](1.0, 5.0, -2.0, 3.0);
)";

class Ranges {
 public:
  explicit Ranges(const std::string& body, ValueContext context = {}, Stage stage = Stage::closestHit)
      : module_(read(body, stage)), ranges_(module_, std::move(context)) {}

  // The range of the value that the k-th store of the shader writes.
  ValueRange stored(std::size_t k = 0) const {
    for (std::size_t i = 0; i < module_.instructions().size(); ++i) {
      const Instruction& store = module_.instructions()[i];
      const Variable* variable =
          store.op == spv::Op::OpStore ? module_.variable(module_.access(store.at(0)).variable) : nullptr;
      if (variable && variable->name == "data" && k-- == 0) return ranges_.rangeAt(i, store.at(1));
    }
    ADD_FAILURE() << "no such store";
    return {};
  }

  // The range of the k-th index of a local array, and whether it is guarded.
  ValueRange index(bool* guarded = nullptr) const {
    for (std::size_t i = 0; i < module_.instructions().size(); ++i) {
      const Instruction& load = module_.instructions()[i];
      const Instruction* chain = load.op == spv::Op::OpLoad ? module_.definition(load.at(0)) : nullptr;
      if (!chain || chain->op != spv::Op::OpAccessChain || module_.isConstant(chain->at(1))) continue;
      if (guarded) *guarded = ranges_.guarded(i, chain->at(1));
      return ranges_.rangeAt(i, chain->at(1));
    }
    ADD_FAILURE() << "no index";
    return {};
  }

 private:
  static Module read(const std::string& body, Stage stage) {
    CompilerOptions options;
    options.debugInfo = true;
    Source source;
    source.stage = stage;
    source.name = "test.glsl";
    source.text = kRangeHead + body;
    Result result = Compiler(options).compile(source);
    EXPECT_TRUE(result.ok()) << all(result);
    return std::move(*Module::read(std::move(result.spirv)));
  }

  Module module_;
  ValueRanges ranges_;
};

ValueRange of(const std::string& body, ValueContext context = {}) {
  return Ranges("void main() { " + body + " }", std::move(context)).stored();
}

testing::AssertionResult isBetween(const ValueRange& range, double min, double max) {
  if (range.min == min && range.max == max && !range.nan) return testing::AssertionSuccess();
  return testing::AssertionFailure() << range.min << " to " << range.max << (range.nan ? " or NaN" : "");
}

TEST(ValueRanges, FollowsConstantsAndComposites) {
  EXPECT_EQ(of("data.x = 2.5;").constant(), 2.5);
  EXPECT_EQ(of("vec3 v = vec3(1.0, data.x, 3.0); data.x = v.zyx.x;").constant(), 3.0);
  EXPECT_EQ(of("data.i = -7;").constant(), -7.0);
}

TEST(ValueRanges, FollowsArithmetic) {
  EXPECT_TRUE(isBetween(of("data.i = gl_PrimitiveID % 5 + 2;"), 2.0, 6.0));
  EXPECT_TRUE(isBetween(of("data.u = (data.u & 7u) * 2u;"), 0.0, 14.0));
  EXPECT_TRUE(isBetween(of("data.u = data.u >> 28;"), 0.0, 15.0));
  EXPECT_TRUE(isBetween(of("data.i = int(min(data.u, 9u)) - 10;"), -10.0, -1.0));
  EXPECT_TRUE(isBetween(of("data.x = clamp(data.x, -1.0, 2.0) * -2.0;"), -4.0, 2.0));
  EXPECT_TRUE(isBetween(of("data.i = abs(clamp(data.i, -3, 2));"), 0.0, 3.0));
  EXPECT_TRUE(isBetween(of("data.u = data.u + 1u;"), 0.0, 4294967295.0));  // wraps
  EXPECT_EQ(of("data.u = data.u | 6u;").ones & 6u, 6u);
  EXPECT_EQ(of("data.u = data.u & ~1u;").zeros & 1u, 1u);
}

TEST(ValueRanges, FollowsChoices) {
  const ValueRange range = of("data.i = data.x > 1.0 ? 4 : 9;");
  EXPECT_EQ(range.values, (std::vector<double>{4.0, 9.0}));
  EXPECT_EQ(range.occurrence, Occurrence::each);
  EXPECT_TRUE(isBetween(of("int k = 1; if (data.x > 1.0) k = 3; data.i = k * 2;"), 2.0, 6.0));
  EXPECT_EQ(of("float y = gl_RayTminEXT < 0.0 ? 1.0 : 2.0; data.x = y;").constant(), 2.0);
}

TEST(ValueRanges, KnowsElementsOfConstantArrays) {
  EXPECT_TRUE(isBetween(of("data.x = kTable[data.u & 3u];"), -2.0, 5.0));
  EXPECT_EQ(of("uint k = gl_RayTminEXT < 0.0 ? 0u : 1u; data.x = kTable[k];").constant(), 5.0);
}

TEST(ValueRanges, KnowsBuiltIns) {
  EXPECT_TRUE(isBetween(of("data.u = gl_HitKindEXT;"), 0.0, 255.0));
  ValueContext context;
  context.builtIns[spv::BuiltIn::InstanceCustomIndexKHR] = ValueRange::among({0.0, 1.0, 4.0}, Occurrence::each);
  const ValueRange range = of("data.i = gl_InstanceCustomIndexEXT * 2;", context);
  EXPECT_EQ(range.values, (std::vector<double>{0.0, 2.0, 8.0}));
  EXPECT_EQ(range.occurrence, Occurrence::each);
  EXPECT_EQ(range.atLeast(5.0), 8.0);
  EXPECT_FALSE(range.atLeast(9.0));
}

TEST(ValueRanges, KnowsHitAttributes) {
  const std::string sum = "hitAttributeEXT vec2 b; void main() { data.x = b.x + b.y; }";
  EXPECT_TRUE(Ranges(sum).stored().nan);
  ValueContext context;
  context.hitAttribute = ValueRange::between(0.0, 1.0);
  EXPECT_TRUE(isBetween(Ranges(sum, context).stored(), 0.0, 2.0));
}

TEST(ValueRanges, LeavesOutNan) {
  EXPECT_TRUE(of("data.x = sin(data.x);").nan);
  ValueContext context;
  context.noNan = true;
  EXPECT_TRUE(isBetween(of("data.x = fract(data.x / data.x);", context), 0.0, 1.0));
  EXPECT_TRUE(of("data.x = sqrt(-1.0 - abs(data.x));", context).onlyNan());
}

TEST(ValueRanges, KnowsParameters) {
  ValueContext context;
  context.members[{"Parameters", "bias"}] = {ValueRange::between(0.0, 0.5)};
  context.members[{"Parameters", "tint"}] = {ValueRange::of(1.0), ValueRange::of(2.0), ValueRange::of(3.0)};
  EXPECT_TRUE(isBetween(of("data.x = parameters.bias * 4.0;", context), 0.0, 2.0));
  EXPECT_EQ(of("data.x = parameters.tint.y;", context).constant(), 2.0);
  EXPECT_TRUE(of("data.u = parameters.mode;", context).max == 4294967295.0);
}

TEST(ValueRanges, BoundsCountedLoops) {
  const std::string loop = "int n = 0; for (int i = 0; i < 6; ++i) { data.i = i; n += i; } data.x = float(n);";
  const ValueRange inside = of(loop);
  EXPECT_TRUE(isBetween(inside, 0.0, 5.0));
  EXPECT_EQ(inside.occurrence, Occurrence::each);
  const ValueRange steps = of("for (int i = 12; i >= 0; i -= 4) data.i = i;");
  EXPECT_EQ(steps.values, (std::vector<double>{0.0, 4.0, 8.0, 12.0}));
  const ValueRange unknownBound = of("for (uint i = 0u; i < data.u; ++i) data.x = float(i);");
  EXPECT_EQ(unknownBound.min, 0.0);
  const ValueRange broken = of("for (int i = 0; i < 6; ++i) { if (data.x > float(i)) break; data.i = i; }");
  EXPECT_TRUE(isBetween(broken, 0.0, 5.0));
  EXPECT_NE(broken.occurrence, Occurrence::each);
  const ValueRange multiplied = of("uint k = 1u; while (data.x > 0.0) { k = k * 3u; data.u = k; }");
  EXPECT_EQ(multiplied.max, 4294967295.0);
}

TEST(ValueRanges, RefinesByBranches) {
  EXPECT_TRUE(isBetween(of("int k = gl_PrimitiveID; if (k < 10 && k > 2) data.i = k;"), 3.0, 9.0));
  EXPECT_TRUE(isBetween(of("int k = gl_PrimitiveID; if (k >= 10) return; data.i = k + 1;"), 1.0, 10.0));
  EXPECT_TRUE(isBetween(of("int k = data.i; if (uint(k) < 4u) data.i = k;"), 0.0, 3.0));
  EXPECT_TRUE(
      isBetween(of("uint k = data.u; switch (k) { case 3u: data.x = float(k); break; default: break; }"), 3.0, 3.0));
  // A comparison with NaN is false: nothing is known after it.
  EXPECT_TRUE(of("float k = data.x; if (!(k < 1.0)) data.x = k;").nan);
  EXPECT_EQ(of("float k = data.x; if (k < 1.0) data.x = k;").max, 1.0);
}

TEST(ValueRanges, LimitsChoicesByTheirOwnBranches) {
  ValueContext context;
  context.members[{"Parameters", "mode"}] = {ValueRange::between(0.0, 2.0, Occurrence::each)};
  EXPECT_EQ(of("int k = 1; if (parameters.mode == 3u) k = 9; data.i = k;", context).constant(), 1.0);
  const ValueRange clamped = of("uint n = parameters.mode; if (n > 1u) n = 1u; data.u = n;", context);
  EXPECT_TRUE(isBetween(clamped, 0.0, 1.0));
  const ValueRange selected = of("data.u = parameters.mode < 2u ? parameters.mode : 7u;", context);
  EXPECT_NE(selected.occurrence, Occurrence::each);  // 2 does not occur
  const ValueRange guarded = of("uint i = data.x > 0.0 ? 9u : 0u; if (i < 2u) data.u = i;");
  EXPECT_EQ(guarded.max, 0.0);
}

TEST(ValueRanges, KnowsLoopsThatCountDown) {
  const ValueRange down = of("for (uint i = 7u; i > 2u; --i) data.u = i;");
  EXPECT_TRUE(isBetween(down, 3.0, 7.0));
  const ValueRange added = of("for (uint i = 7u; i > 2u; i += 0xFFFFFFFFu) data.u = i;");
  EXPECT_TRUE(isBetween(added, 3.0, 7.0));
  // 0 wraps around before the condition is tested.
  const ValueRange wraps = of("uint i = data.u & 7u; do { --i; data.u = i; } while (i > 2u);");
  EXPECT_EQ(wraps.max, 4294967295.0);
}

TEST(ValueRanges, FindsGuards) {
  const std::string table = "float a[4] = float[](data.x, 1.0, 2.0, 3.0); ";
  bool guarded = false;
  const ValueRange range = Ranges("void main() { " + table + "data.x = a[gl_PrimitiveID % 8]; }").index(&guarded);
  EXPECT_EQ(range.atLeast(4.0), 7.0);
  EXPECT_FALSE(guarded);
  Ranges("void main() { " + table + "if (data.u != 0u) data.x = a[gl_PrimitiveID % 8]; }").index(&guarded);
  EXPECT_FALSE(guarded);
  Ranges("void main() { " + table +
         "if ((gl_PrimitiveID & 15) != 7) data.x = a[gl_PrimitiveID % 8]; else data.u = 1u; }")
      .index(&guarded);
  EXPECT_TRUE(guarded);
}

TEST(ValueRanges, AcceptsAnyModuleSafely) {
  CompilerOptions options;
  options.debugInfo = true;
  Source source;
  source.stage = Stage::closestHit;
  source.name = "test.glsl";
  source.text = kRangeHead + std::string(R"(void main() {
  float a[4] = float[](data.x, 1.0, 2.0, 3.0);
  for (int i = 0; i < 4; ++i) data.x += a[i] * kTable[(i + gl_PrimitiveID) & 3];
  vec3 v = clamp(parameters.tint, vec3(0.0), vec3(data.x)) / max(data.x, 0.5);
  switch (data.u % 3u) { case 1u: v.x = sqrt(v.y); break; default: v = v.zyx; }
  data.i = int(v.x) >> (data.i & 3);
  data.u = data.i < 0 ? data.u - 3u : ~data.u;
}
)");
  const Result result = Compiler(options).compile(source);
  ASSERT_TRUE(result.ok()) << all(result);
  std::mt19937 random(7);
  const auto pick = [&](std::size_t below) { return static_cast<std::size_t>(random() % below); };
  std::size_t known = 0;
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::uint32_t> words = result.spirv;
    for (std::size_t k = 1 + pick(5); k > 0; --k) {
      std::uint32_t& word = words[pick(words.size())];
      word = pick(3) == 0   ? static_cast<std::uint32_t>(pick(words[3] + 2))
             : pick(2) == 0 ? words[pick(words.size())]
                            : word ^ (1u << pick(32));
    }
    auto module = Module::read(std::move(words));
    if (!module) continue;
    const ValueRanges ranges(*module);
    for (std::size_t i = 0; i < module->instructions().size(); ++i) {
      for (const Id id : valueOperands(module->instructions()[i]))
        known += ranges.rangeAt(i, id).constant() || ranges.rangeAt(i, id, {1}).constant() ? 1 : 0;
    }
  }
  EXPECT_GT(known, 1000u);
}

}  // namespace
}  // namespace quintet::spirv
