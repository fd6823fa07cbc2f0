// SPDX-License-Identifier: Apache-2.0
#include "shader/macro_expansion.h"

#include <string>

#include <gmock/gmock.h>

#include "shader/deep_stack.h"
#include "shader_test_support.h"

namespace quintet::shader {
namespace {

using ::testing::HasSubstr;

std::optional<LargeExpansion> largeIn(const std::string& text) { return findLargeExpansion({{"a.glsl", text}}, {}); }

// Each macro names the one before twice.
std::string doubling(int levels, const std::string& begin = "1") {
  std::string text = "#define A0 " + begin + "\n";
  for (int i = 1; i <= levels; ++i)
    text += "#define A" + std::to_string(i) + " A" + std::to_string(i - 1) + " + A" + std::to_string(i - 1) + "\n";
  return text;
}

TEST(MacroExpansion, FindsMacrosThatDouble) {
  EXPECT_FALSE(largeIn(doubling(40)));  // defined, but not used
  EXPECT_FALSE(largeIn(doubling(20) + "int x = A20;\n"));
  const auto large = largeIn(doubling(21) + "int y = A3;\nint x = A21;\n");
  ASSERT_TRUE(large);
  EXPECT_EQ(large->macro, "A21");
  EXPECT_EQ(large->file, "a.glsl");
  EXPECT_EQ(large->line, 24);
  EXPECT_TRUE(largeIn(doubling(1000) + "int x = A1000;\n"));
  EXPECT_TRUE(largeIn(doubling(40) + "#if A40\n#endif\n"));
}

TEST(MacroExpansion, FollowsArguments) {
  std::string text = "#define TWICE(x) (x) + (x)\n#define ALSO TWICE\nint x = ";
  for (int i = 0; i < 30; ++i) text += i % 2 ? "TWICE(" : "ALSO(";
  text += "1" + std::string(30, ')') + ";\n";
  const auto large = largeIn(text);
  ASSERT_TRUE(large);
  EXPECT_EQ(large->line, 3);
  std::string chain = "#define F0(x, y) x y\n";
  for (int i = 1; i < 30; ++i)
    chain += "#define F" + std::to_string(i) + "(x, y) F" + std::to_string(i - 1) + "(y x, (x, x)) \\\n y\n";
  EXPECT_TRUE(largeIn(chain + "F29(1, 2)\n"));
  EXPECT_FALSE(largeIn("#define F(x) 1\nF(F(F(F(1, 2), 3)))\n"));
}

TEST(MacroExpansion, AcceptsRecursionCommentsAndUnusualText) {
  EXPECT_FALSE(largeIn("#define A A A A\n#define B C C\n#define C B B\nA B C\n"));
  EXPECT_FALSE(largeIn(doubling(40) + "// A40\n/* A40\nA40 */ int x;\n#pragma A40\n#error A40\n"));
  for (const char* text : {"#define", "#define F(", "#define F(x", "#define F(x) x\nF(", "F)(", "#", "#define 3 4",
                           "\\", "/*", "//", "\\\n", "#define F(x) x x\nF((,),)"})
    EXPECT_FALSE(largeIn(text)) << text;
}

TEST(MacroExpansion, ReadsDeepTextsFast) {
  std::string text = "#define F(x) x\n";
  for (int i = 0; i < 200'000; ++i) text += "F(";
  text += std::string(200'000, ')');
  runOnDeepStack(stackBytesFor(text.size()), [&] { EXPECT_FALSE(largeIn(text)); });
}

TEST(Compile, RejectsMacrosThatWouldTakeAllMemory) {
  const Result result = Compiler({}).compile(computeSource(doubling(40), "b.x = A40;"));
  const Diagnostic* error = firstOf(result, Severity::error);
  ASSERT_TRUE(error);
  EXPECT_THAT(error->text,
              HasSubstr("the macro 'A40' expands to too much text: the compiler would need more than 1000 MB"));
  EXPECT_GT(error->line, 0);
}

}  // namespace
}  // namespace quintet::shader
