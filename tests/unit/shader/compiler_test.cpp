// SPDX-License-Identifier: Apache-2.0
// Compiles sources to SPIR-V, or to diagnostics that point into the right file.
#include <thread>

#include "base/error.h"
#include "shader/optimizer.h"
#include "shader_test_support.h"

namespace quintet::shader {

constexpr std::uint32_t kSpirv16 = 0x0001'0600;

TEST(Compiler, CompilesEveryStage) {
  const Compiler compiler({});
  const std::string head = "#version 460\n#extension GL_EXT_ray_tracing : require\n";
  const std::pair<Stage, std::string> sources[] = {
      {Stage::rayGeneration, "void main() {}"},
      {Stage::intersection, "void main() { reportIntersectionEXT(1.0, 0u); }"},
      {Stage::anyHit, "void main() { ignoreIntersectionEXT; }"},
      {Stage::closestHit, "layout(location = 0) rayPayloadInEXT vec3 p; void main() { p = vec3(gl_HitTEXT); }"},
      {Stage::miss, "layout(location = 0) rayPayloadInEXT vec3 p; void main() { p = vec3(0); }"},
      {Stage::callable, "layout(location = 0) callableDataInEXT vec3 p; void main() { p = vec3(0); }"},
      {Stage::compute, "void main() {}"},
  };
  for (const auto& [stage, text] : sources) {
    Source source;
    source.stage = stage;
    source.text = head + text;
    const Result result = compiler.compile(source);
    ASSERT_TRUE(result.ok()) << stageName(stage) << "\n" << all(result);
    EXPECT_EQ(result.spirv[1], kSpirv16);
    EXPECT_TRUE(result.diagnostics.empty()) << all(result);
    EXPECT_FALSE(result.fromCache);
  }
}

TEST(Compiler, ReportsFileLineAndColumn) {
  const Result result = Compiler({}).compile(computeSource("int f() {\n  return nowhere;\n}"));
  ASSERT_FALSE(result.ok());
  const Diagnostic& error = result.diagnostics.at(0);
  EXPECT_EQ(error.file, "test.comp");
  EXPECT_EQ(error.line, 5);
  EXPECT_EQ(error.column, 10);
  EXPECT_EQ(error.id, "GLSL");
  EXPECT_EQ(error.text, "'nowhere' : undeclared identifier");
}

TEST(Compiler, NamesTheWrongCharacter) {
  const auto errorFor = [](const std::string& body) {
    const Result result = Compiler({}).compile(computeSource(body));
    return result.ok() ? "none" : result.diagnostics.at(0).format();
  };
  EXPECT_EQ(errorFor("float f() { return 1.0”; }"),
            "test.comp:4:23: error: '”' : unexpected token; ” is a typographic quote; type \" instead [GLSL]");
  EXPECT_EQ(errorFor("float f() { return 2.0 – 1.0; }  // the light’s power"),
            "test.comp:4:24: error: '–' : unexpected token [GLSL]");
  EXPECT_EQ(errorFor("#define kOne ‘1.0’  // one\n\nfloat f() { return kOne; }"),
            "test.comp:4:14: error: '‘' : unexpected token; ‘ is a typographic quote; type ' instead [GLSL]");
  EXPECT_EQ(errorFor("#include “a.glsl”"),
            "test.comp:4:10: error: '#include' : must be followed by a header name; “ is a typographic quote; type \" "
            "instead [GLSL]");
  EXPECT_EQ(errorFor("#include <missing.glsl>  // the light’s power").find("typographic"), std::string::npos);
  EXPECT_EQ(errorFor("float f() { return 1.0; }  // the light’s power"), "none");
}

TEST(Compiler, DropsFollowUpErrors) {
  const Result result =
      Compiler({}).compile(computeSource("int f() { return nowhere.x + nowhere.y * 2.0; }\nint g() { return gone; }"));
  ASSERT_EQ(result.diagnostics.size(), 2u) << all(result);
  EXPECT_EQ(result.diagnostics[0].text, "'nowhere' : undeclared identifier");
  EXPECT_EQ(result.diagnostics[1].text, "'gone' : undeclared identifier");
}

TEST(Compiler, JoinsMessagesOfSeveralLines) {
  Source source;
  source.stage = Stage::closestHit;
  source.name = "hit.rchit";
  source.text = "#version 460\nvoid main() { int i = gl_PrimitiveID; }\n";
  const Result result = Compiler({}).compile(source);
  ASSERT_EQ(result.diagnostics.size(), 1u) << all(result);
  EXPECT_EQ(result.diagnostics[0].line, 2);
  EXPECT_NE(result.diagnostics[0].text.find("GL_EXT_ray_tracing"), std::string::npos);
  EXPECT_EQ(result.diagnostics[0].text.find("hit.rchit"), std::string::npos) << result.diagnostics[0].text;
}

TEST(Compiler, AcceptsNamesWithColonsAndSpaces) {
  const Result result = Compiler({}).compile(computeSource("int f() { return nowhere; }", "", "c:/a b:c.comp"));
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.diagnostics.at(0).file, "c:/a b:c.comp");
  EXPECT_EQ(result.diagnostics.at(0).line, 4);
}

TEST(Compiler, FollowsLineDirectives) {
  const Result result = Compiler({}).compile(computeSource("#line 70 \"model.frag\"\nint f() { return nowhere; }"));
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.diagnostics.at(0).file, "model.frag");
  EXPECT_EQ(result.diagnostics.at(0).line, 70);
}

TEST(Compiler, KeepsWarnings) {
  const Result result = Compiler({}).compile(computeSource("#extension GL_EXT_does_not_exist : enable"));
  ASSERT_TRUE(result.ok()) << all(result);
  ASSERT_EQ(result.diagnostics.size(), 1u) << all(result);
  EXPECT_EQ(result.diagnostics[0].severity, Severity::warning);
  EXPECT_EQ(result.diagnostics[0].line, 4);
}

TEST(Compiler, CompilesOtherVersionsAs460WithAWarning) {
  Source source;
  source.text = "#version 450\nvoid main() {}\n";
  const Result result = Compiler({}).compile(source);
  ASSERT_TRUE(result.ok()) << all(result);
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_NE(result.diagnostics[0].text.find("450"), std::string::npos);
  source.text = "void main() {}\n";
  EXPECT_TRUE(Compiler({}).compile(source).ok());
}

TEST(Compiler, AppliesDefines) {
  Source source = computeSource("#ifndef ON\n#error off\n#endif", "b.x = VALUE;");
  source.defines = {{"ON", ""}, {"VALUE", "7"}};
  EXPECT_TRUE(Compiler({}).compile(source).ok());
  source.defines = {{"VALUE", "7"}};
  const Result result = Compiler({}).compile(source);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.diagnostics.at(0).line, 5);
}

TEST(Compiler, RejectsInvalidDefines) {
  for (const auto& [name, value] :
       {std::pair<std::string, std::string>{"", "1"}, {"A B", "1"}, {"1A", ""}, {"A", "1\nint x;"}}) {
    Source source = computeSource("");
    source.defines = {{name, value}};
    const Result result = Compiler({}).compile(source);
    EXPECT_FALSE(result.ok());
    EXPECT_EQ(result.diagnostics.size(), 1u);
  }
}

TEST(Compiler, AppliesOptions) {
  Source source = computeSource("int f(int x) { return x * 2 + 0; }", "b.x = f(b.x) + f(3);");
  CompilerOptions options;
  options.debugInfo = false;
  const Result fast = Compiler(options).compile(source);
  options.optimize = false;
  const Result plain = Compiler(options).compile(source);
  options.debugInfo = true;
  const Result debug = Compiler(options).compile(source);
  ASSERT_TRUE(fast.ok() && plain.ok() && debug.ok());
  EXPECT_LT(fast.spirv.size(), plain.spirv.size());
  EXPECT_LT(plain.spirv.size(), debug.spirv.size());
}

TEST(Compiler, OptimizesChangedModules) {
  Source source = computeSource("int f(int x) { return x * 2 + 0; }", "b.x = f(b.x) + f(3);");
  const Compiler compiler({});
  const Result optimized = compiler.compile(source);
  source.optimize = false;
  const Result plain = compiler.compile(source);
  ASSERT_TRUE(optimized.ok() && plain.ok());
  EXPECT_EQ(compiler.optimize(plain.spirv), optimized.spirv);
  std::vector<std::uint32_t> invalid = plain.spirv;
  invalid.pop_back();
  EXPECT_THROW(compiler.optimize(invalid), Error);
}

TEST(Compiler, DraftsLargeModulesThatItHasNotCompiledYet) {
  std::string body;
  for (int i = 0; i < 3000; ++i) body += "b.x = b.x * 3 + " + std::to_string(i) + ";\n";
  const Compiler compiler({});
  std::vector<std::vector<std::uint32_t>> drafts;
  const auto onDraft = [&](std::vector<std::uint32_t> spirv) { drafts.push_back(std::move(spirv)); };
  const Result complete = compiler.compile(computeSource("", body), onDraft);
  ASSERT_TRUE(complete.ok());
  ASSERT_EQ(drafts.size(), 1u);
  EXPECT_EQ(validate(drafts[0]).text, "");
  EXPECT_NE(drafts[0], complete.spirv);
  EXPECT_EQ(compiler.compile(computeSource("", body), onDraft).spirv, complete.spirv);
  compiler.compile(computeSource("", "b.x = 2;"), onDraft);
  EXPECT_EQ(drafts.size(), 1u) << "of a cached module, and of a small one";
  EXPECT_EQ(Compiler({}).compile(computeSource("", body)).spirv, complete.spirv) << "a draft changes the result";
  std::vector<std::uint32_t> invalid = complete.spirv;
  invalid.pop_back();
  EXPECT_THROW(draft(invalid), Error);
}

TEST(Compiler, CompilesOnSeveralThreads) {
  const Compiler compiler({});
  const Result expected = compiler.compile(computeSource("int f() { return 1; }", "b.x = f();"));
  std::vector<Result> results(8);
  {
    std::vector<std::jthread> threads;
    for (Result& result : results)
      threads.emplace_back([&] { result = compiler.compile(computeSource("int f() { return 1; }", "b.x = f();")); });
  }
  for (const Result& result : results) EXPECT_EQ(result.spirv, expected.spirv);
}

}  // namespace quintet::shader
