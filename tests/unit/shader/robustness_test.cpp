// SPDX-License-Identifier: Apache-2.0
// Any text gives a result and diagnostics without a crash.
#include <random>

#include "shader_test_support.h"

namespace quintet::shader {
namespace {

void expectDiagnosed(const Compiler& compiler, const std::string& text) {
  Source source;
  source.text = text;
  source.name = "fuzz.comp";
  const Result result = compiler.compile(source);
  EXPECT_EQ(result.ok(), firstOf(result, Severity::error) == nullptr) << text.substr(0, 200);
}

TEST(Robustness, AcceptsUnusualTexts) {
  const Compiler compiler({});
  const std::string texts[] = {
      "",
      " ",
      "\n",
      "#",
      "#version",
      "#version 460",
      "#version 99999999999999999999",
      "#include",
      "#include \"\"",
      "#include <>",
      "#include <.>",
      "#include \"/\"",
      "#line",
      "#line 4294967295 \"x\"\nerror",
      "#if",
      "#error",
      "\xff\xfe",
      "\xef\xbb\xbf#version 460\nvoid main() {}",
      "void main() {",
      "/*",
      "//\\",
      "\\\n\\\n",
      "#define A A\nA",
      "#pragma once",
      "#version 300 es\nvoid main() {}",
      "#version 110\nvoid main() {}",
      "\"",
      "'",
      "main",
      std::string(1 << 20, ' '),
      std::string(1 << 20, 'x'),
      std::string(1 << 16, '('),
      std::string(1 << 16, '{'),
      std::string(1 << 16, '\n'),
      "#define A(x) x x\nA(A(A(A(A(A(A(A(A(1)))))))))",
      std::string(5 << 20, 'x'),
  };
  for (const std::string& text : texts) expectDiagnosed(compiler, text);
}

TEST(Robustness, ReportsTheLineOfANulByte) {
  const Result result = Compiler({}).compile(computeSource(std::string("int a;\nint \0 b;", 14)));
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].line, 5);
  Source source = computeSource("#include <n>");
  source.virtualFiles["n"] = std::string("int \0 b;", 8);
  EXPECT_FALSE(Compiler({}).compile(source).ok());
}

TEST(Robustness, CompilesDeepExpressions) {
  std::string sum = "b.x = b.x", nested = "b.x = ";
  for (int k = 0; k < 20'000; ++k) sum += "+b.x";
  for (int k = 0; k < 2'000; ++k) nested += "(-";
  nested += "b.x" + std::string(2'000, ')') + ";";
  CompilerOptions options;
  options.optimize = false;
  const Compiler compiler(options);
  EXPECT_TRUE(compiler.compile(computeSource("", sum + ";")).ok());
  expectDiagnosed(compiler, computeText("", nested));
}

TEST(Robustness, AcceptsRandomBytesAndMutations) {
  const Compiler compiler({});
  std::mt19937 random(1);
  const std::string good =
      computeText("#include <x>\n#define F(a) (a + 1)\nint f(int a) { return a > 3 ? F(a) : -a; }", "b.x = f(b.x);");
  for (int k = 0; k < 400; ++k) {
    std::string text = good;
    if (k % 4 == 0) {
      text.resize(random() % 300);
      for (char& c : text) c = static_cast<char>(random());
    } else {
      for (unsigned change = 1 + random() % 4; change > 0; --change) {
        const std::size_t at = random() % text.size();
        switch (random() % 3) {
          case 0: text.erase(at, 1 + random() % 5); break;
          case 1: text.insert(at, text.substr(random() % text.size(), random() % 30)); break;
          default: text[at] = static_cast<char>(random() % 128); break;
        }
      }
    }
    expectDiagnosed(compiler, text);
  }
}

}  // namespace
}  // namespace quintet::shader
