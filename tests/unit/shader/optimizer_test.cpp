// SPDX-License-Identifier: Apache-2.0
// Optimization of modules of unknown origin, which runs only the passes that can change a module.
#include "shader/optimizer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <spirv/unified1/spirv.hpp11>
#include <string>
#include <vector>

#include "shader_test_support.h"

namespace quintet::shader {
namespace {

std::size_t countOf(const std::vector<std::uint32_t>& words, spv::Op op) {
  constexpr std::size_t kHeader = 5;
  std::size_t count = 0;
  for (std::size_t at = kHeader; at < words.size(); at += std::max(1u, words[at] >> 16))
    if (static_cast<spv::Op>(words[at] & 0xFFFFu) == op) ++count;
  return count;
}

std::vector<std::uint32_t> unoptimized(const std::string& head, const std::string& body) {
  const Compiler compiler({.libraryOverride = {}, .includeFolders = {}, .cacheFolder = {}, .optimize = false});
  return compiler.compile(computeSource(head, body)).spirv;
}

// The check follows values through functions only if these are inlined, which needs one return at the end.
TEST(UntrustedModules, FunctionsThatReturnEarlyAreInlined) {
  for (const char* function : {
           "int f(int n) { for (int i = 0;; ++i) if (i * i > n) return i; }",
           "int f(int n) { if (n > 7) return n; return 2 * n; }",
           "int f(int n) { switch (n) { case 1: return 5; default: return 9; } }",
           "int f(int n) { return 3 * n; }",
       }) {
    const std::vector<std::uint32_t> words = unoptimized(function, "b.x = f(b.x);");
    ASSERT_EQ(countOf(words, spv::Op::OpFunctionCall), 1u) << function;
    const std::vector<std::uint32_t> result = optimizeSpecialized(words, {});
    EXPECT_EQ(countOf(result, spv::Op::OpFunctionCall), 0u) << function;
    EXPECT_EQ(countOf(result, spv::Op::OpFunction), 1u) << function;
  }
}

}  // namespace
}  // namespace quintet::shader
