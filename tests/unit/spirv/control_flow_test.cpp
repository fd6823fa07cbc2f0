// SPDX-License-Identifier: Apache-2.0
// The branches that decide whether a block runs, and what a value depends on.
#include "spirv/control_flow.h"

#include "shader/shader_test_support.h"

namespace quintet::spirv {
using namespace shader;

namespace {

Module compiled(const std::string& body) {
  CompilerOptions options;
  options.debugInfo = true;
  Source source;
  source.stage = Stage::closestHit;
  source.name = "test.glsl";
  source.text =
      "#version 460\n#extension GL_EXT_ray_tracing : require\n"
      "layout(location = 0) rayPayloadInEXT struct Data { float x, y, z; bool a, b; } data;\n"
      "hitAttributeEXT vec2 weights;\nvoid main() {\n" +
      body + "\n}\n";
  Result result = Compiler(options).compile(source);
  EXPECT_TRUE(result.ok()) << all(result);
  return std::move(*Module::read(std::move(result.spirv)));
}

// Indices of the stores to the payload.
std::vector<std::size_t> storesOf(const Module& module) {
  std::vector<std::size_t> stores;
  for (std::size_t i = 0; i < module.instructions().size(); ++i) {
    const Instruction& store = module.instructions()[i];
    if (store.op == spv::Op::OpStore && module.variable(module.access(store.at(0)).variable)) stores.push_back(i);
  }
  return stores;
}

// The number of branches that decide whether each store runs.
std::vector<std::size_t> controllersOfStores(const std::string& body) {
  const Module module = compiled(body);
  std::vector<std::size_t> counts;
  for (const std::size_t store : storesOf(module)) {
    const auto position = module.position(store);
    counts.push_back(ControlFlow(module, position->function).controllers(position->block).size());
  }
  return counts;
}

TEST(ControlFlow, FindsTheBranchesThatDecideWhetherABlockRuns) {
  using Counts = std::vector<std::size_t>;
  EXPECT_EQ(controllersOfStores("data.x = gl_HitTEXT;"), Counts{0});
  EXPECT_EQ(controllersOfStores("if (data.a) data.x = 1.0; data.y = 2.0;"), (Counts{1, 0}));
  EXPECT_EQ(controllersOfStores("if (data.a) { data.x = 1.0; if (data.b) data.y = 2.0; } data.z = 3.0;"),
            (Counts{1, 2, 0}));
  EXPECT_EQ(controllersOfStores("data.x = 1.0; if (data.a) return; data.y = 2.0;"), (Counts{0, 1}));
  EXPECT_EQ(controllersOfStores("if (data.a || data.b) data.x = 1.0; data.y = 2.0;").back(), 0u);
  EXPECT_EQ(controllersOfStores("for (int i = 0; i < int(gl_HitTEXT); ++i) data.x += 1.0; data.y = 2.0;"),
            (Counts{1, 0}));
}

TEST(ControlFlow, FollowsTheConditionsOfPhis) {
  const auto dependsOnTheAttribute = [](const std::string& body) {
    const Module module = compiled(body);
    const std::size_t store = storesOf(module).back();
    const ControlFlow flow(module, module.position(store)->function);
    return dependsOnDataOrControl(module, flow, module.instructions()[store].at(1), [&](const Instruction& i) {
      const Variable* variable = i.op == spv::Op::OpLoad ? module.variable(module.access(i.at(0)).variable) : nullptr;
      return variable && variable->storage == spv::StorageClass::HitAttributeKHR;
    });
  };
  EXPECT_TRUE(dependsOnTheAttribute("data.x = weights.x;"));
  EXPECT_FALSE(dependsOnTheAttribute("if (weights.x > 0.5) data.y = 1.0; data.x = data.z;"));
  // The stored value is a phi.
  const std::string choice = "float v = data.y; if (weights.x > 0.5) { v = data.z; data.z = 0.0; } data.x = v;";
  EXPECT_TRUE(dependsOnTheAttribute(choice));
  // The condition is a phi: && does not evaluate its right side if the left one is false.
  EXPECT_TRUE(
      dependsOnTheAttribute("float v = data.y; bool c = data.a; if (c) { data.z = 0.0; c = weights.x > 0.5; }"
                            " if (c) { v = data.z; data.z = 1.0; } data.x = v;"));
}

}  // namespace
}  // namespace quintet::spirv
