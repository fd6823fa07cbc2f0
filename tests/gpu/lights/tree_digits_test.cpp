// SPDX-License-Identifier: Apache-2.0
// Sampling of the tree against exact integer arithmetic. Floats would round the number that decides.
#include <array>
#include <random>

#include <gtest/gtest.h>

#include "lights/light_scene.h"

namespace quintet::test {
namespace {

constexpr std::uint32_t kOne = 0x80000000u;

std::uint32_t quotient(std::uint32_t d, std::uint32_t r, std::uint32_t part) {
  return static_cast<std::uint32_t>(((std::uint64_t{d} << 31) | r) / part);
}

// Of quintet/sampling/hash.glsl.
std::uint32_t hash(std::uint32_t x) {
  x = (x ^ x >> 16) * 0x21F0AAADu;
  x = (x ^ x >> 15) * 0xD35A2D97u;
  return x ^ x >> 15;
}

std::vector<std::uint32_t> randomWords(std::size_t count) {
  std::mt19937 engine(1);
  std::vector<std::uint32_t> words(count);
  for (std::uint32_t& word : words) word = static_cast<std::uint32_t>(engine());
  return words;
}

TEST(LightTreeDigits, QuotientsAreExact) {
  struct In {
    std::uint32_t d, r, part;
  };
  std::vector<In> inputs;
  const std::vector<std::uint32_t> words = randomWords(3'000'000);
  for (std::uint32_t i = 0; i < 1'000'000; ++i) {
    const std::uint32_t a = words[3 * i], b = words[3 * i + 1];
    std::uint32_t part = std::max(1u, (a >> i % 32) >> 1), r = words[3 * i + 2] >> 1;
    if (i % 7 == 0) part = 1u << i % 32;
    if (i % 11 == 0) part = kOne - (a >> (20 + i % 12));
    std::uint32_t d = b % part;
    if (i % 3 == 0) d = part - 1 - d % std::min(part, 200u);
    if (i % 5 == 0) d %= std::min(part, 200u);
    if (i % 13 == 0) r = i % 2 ? 0 : kOne - 1;
    // The first with its quotient, or the last with the one before.
    if (i % 17 == 0)
      r -= static_cast<std::uint32_t>(std::min<std::uint64_t>(r, (std::uint64_t{d} << 31 | r) % part + i % 2));
    inputs.push_back({d, r, part});
  }
  const auto found = runCompute<std::uint32_t>(R"(
    #include <quintet/lights/tree.glsl>
    struct In { uint d; uint r; uint part; };
    #define Out uint
    uint run(uint i, In v) { return lightDigits(v.d, v.r, v.part); }
  )",
                                               inputs, inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto& [d, r, part] = inputs[i];
    ASSERT_EQ(found[i], quotient(d, r, part)) << d << " " << r << " / " << part;
  }
}

// Lamps of very different strength, in two groups: numbers at the ends of each group's range decide about the faintest.
TEST(LightTreeDigits, DrawsAreThoseOfExactArithmetic) {
  scene::Scene source;
  for (const auto& [x, intensity] :
       {std::pair{-10.0f, 1.0f}, {-10.1f, 1e-7f}, {10.0f, 1.0f}, {10.1f, 1e-7f}, {10.2f, 3e-8f}}) {
    scene::Light& light = source.lights.emplace_back();
    light.position = {x, 0, 0};
    light.intensity = vec3(intensity);
  }
  const LightScene scene(source, {});
  const std::string at =
      "#include <quintet/lights/tree.glsl>\nLightSampleContext here() { return lightSampleContext(vec3(0.0)); }\n";
  std::vector<std::uint32_t> nodes(scene.table.nodes.size());
  std::iota(nodes.begin(), nodes.end(), 0u);
  const auto chances = runCompute<std::uint32_t>(at + R"(
    #define In uint
    #define Out uint
    uint run(uint i, uint node) {
      const uint link = LightNodeArray(frame.lightNodes).at[node].link;
      uvec2 links;
      return (link & kLightNodeLeaf) != 0u ? 0u : lightFirstProbability(link & kLightNodeIndex, here(), links);
    }
  )",
                                                 nodes, nodes.size(), scene.options());

  struct In {
    float u;
    std::uint32_t bits;
  };
  std::vector<In> inputs;
  const std::vector<std::uint32_t> words = randomWords(400'000);
  for (std::uint32_t i = 0; i < 200'000; ++i) {
    const std::uint32_t c = chances[0], k = words[2 * i] >> (20 + i % 3);
    const std::uint32_t digits = std::array{k, c - 1 - k, c + k, kOne - 1 - k}[i / 3 % 4];
    inputs.push_back({static_cast<float>(digits >> 7) * 0x1p-24f, (words[2 * i + 1] & ~127u) | (digits & 127u)});
  }
  const auto found = runCompute<std::uint32_t>(at + R"(
    struct In { float u; uint bits; };
    #define Out uint
    uint run(uint i, In v) { float probability; return drawLight(here(), v.u, v.bits, probability); }
  )",
                                               inputs, inputs.size(), scene.options());

  std::vector<std::size_t> counts(source.lights.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    std::uint32_t bits = inputs[i].bits, node = 0;
    std::uint32_t digits = static_cast<std::uint32_t>(inputs[i].u * 0x1p24f) << 7 | (bits & 127u);
    while ((scene.table.nodes[node].link & shared::kLightNodeLeaf) == 0) {
      const std::uint32_t chance = chances[node], pair = scene.table.nodes[node].link & shared::kLightNodeIndex;
      const bool first = digits < chance;
      bits = hash(bits + 0x9E3779B9u);
      digits = quotient(first ? digits : digits - chance, bits >> 1, first ? chance : kOne - chance);
      node = first ? pair : pair + 1;
    }
    const std::uint32_t wanted = scene.table.nodes[node].link & shared::kLightNodeIndex;
    ASSERT_EQ(found[i], wanted) << inputs[i].u << " " << inputs[i].bits;
    ++counts[wanted];
  }
  for (const std::size_t count : counts) EXPECT_GT(count, 0u);
}

}  // namespace
}  // namespace quintet::test
