// SPDX-License-Identifier: Apache-2.0
// Includes: the order of the search, and diagnostics for included and missing files.
#include "shader/include_resolver.h"
#include "base/file_roots.h"

#include <cstdlib>

#include "shader_test_support.h"

namespace quintet::shader {
namespace {

constexpr std::string_view kBroken = "// one\n// two\nint broken() { return nowhere; }\n";

TEST(Include, ReportsErrorsInAVirtualFile) {
  Source source = computeSource("#include <quintet/generated/program.glsl>\nint g() { return missing; }");
  source.virtualFiles["quintet/generated/program.glsl"] = kBroken;
  const Result result = Compiler({}).compile(source);
  ASSERT_GE(result.diagnostics.size(), 2u) << all(result);
  EXPECT_EQ(result.diagnostics[0].file, "<quintet/generated/program.glsl>");
  EXPECT_EQ(result.diagnostics[0].line, 3);
  EXPECT_EQ(result.diagnostics[0].column, 23);
  const auto outer = std::ranges::find(result.diagnostics, "test.comp", &Diagnostic::file);
  ASSERT_NE(outer, result.diagnostics.end()) << all(result);
  EXPECT_EQ(outer->line, 5);  // line numbers continue after the include
}

TEST(Include, ResolvesRelativePathsAmongVirtualFiles) {
  Source source = computeSource("#include <quintet/a/one.glsl>", "b.x = two() + three();");
  source.virtualFiles["quintet/a/one.glsl"] = "#include \"two.glsl\"\n#include \"../three.glsl\"\n";
  source.virtualFiles["<quintet/a/two.glsl>"] = "int two() { return 2; }\n";  // brackets are allowed
  source.virtualFiles["quintet/three.glsl"] = "int three() { return 3; }\n";
  const Result result = Compiler({}).compile(source);
  EXPECT_TRUE(result.ok()) << all(result);
  EXPECT_TRUE(result.files.empty());
}

// A file of a program's folder is in memory and includes a file outside of the folder.
TEST(Include, ResolvesFromAVirtualFileToTheDisk) {
  const TemporaryFolder folder;
  const auto outside = folder.write("outside.glsl", "int two() { return 2; }\n");
  const std::string inside = (folder.path() / "program" / "inside.glsl").string();
  Source source =
      computeSource("#include \"inside.glsl\"", "b.x = two();", (folder.path() / "program" / "main.comp").string());
  source.virtualFiles[inside] = "#include \"../outside.glsl\"\n";
  const Result result = Compiler({}).compile(source);
  EXPECT_TRUE(result.ok()) << all(result);
  ASSERT_EQ(result.files.size(), 1u);
  EXPECT_EQ(result.files[0], outside);
}

TEST(Include, FindsQuotedFilesNextToTheIncludingFile) {
  const TemporaryFolder folder;
  const auto main = folder.path() / "main.comp";
  const auto one = folder.write("sub/one.glsl", "#include \"two.glsl\"\n");
  const auto two = folder.write("sub/two.glsl", "int two() { return 2; }\n");
  folder.write("two.glsl", "#error wrong file\n");
  const Result result = Compiler({}).compile(computeSource("#include \"sub/one.glsl\"", "b.x = two();", main.string()));
  EXPECT_TRUE(result.ok()) << all(result);
  EXPECT_EQ(result.files, (std::vector<std::filesystem::path>{one, two}));
  const auto hashOf = [](std::string_view text) { return Hasher().add(text).finish(); };
  EXPECT_EQ(result.fileHashes,
            (std::vector<Hash>{hashOf("#include \"two.glsl\"\n"), hashOf("int two() { return 2; }\n")}));
}

TEST(Include, ReportsErrorsInAFileOnDisk) {
  const TemporaryFolder folder;
  const auto one = folder.write("one.glsl", kBroken);
  const Result result =
      Compiler({}).compile(computeSource("#include \"one.glsl\"", "", (folder.path() / "m.comp").string()));
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.diagnostics.at(0).file, one.string());
  EXPECT_EQ(result.diagnostics.at(0).line, 3);
}

TEST(Include, SearchesFoldersInOrder) {
  const TemporaryFolder over, first, second;
  Source source = computeSource("#include <lib/x.glsl>", "b.x = X;");
  CompilerOptions options;
  options.libraryOverride = over.path();
  options.includeFolders = {first.path(), second.path()};
  const auto definesX = [&](const std::string& value) {
    Source with = source;
    with.text += "\n#if X != " + value + "\n#error wrong x\n#endif\n";
    const Result result = Compiler(options).compile(with);
    return result.ok() ? "yes" : all(result);
  };
  second.write("lib/x.glsl", "#define X 1\n");
  EXPECT_EQ(definesX("1"), "yes");
  first.write("lib/x.glsl", "#define X 2\n");
  EXPECT_EQ(definesX("2"), "yes");
  over.write("lib/x.glsl", "#define X 3\n");
  EXPECT_EQ(definesX("3"), "yes");
  source.virtualFiles["lib/x.glsl"] = "#define X 4\n";
  EXPECT_EQ(definesX("4"), "yes");
}

TEST(Include, SearchesTheLibraryBetweenOverrideAndFolders) {
  const EmbeddedFile library[] = {{"quintet/a/one.glsl", "ONE"}, {"quintet/two.glsl", "TWO"}};
  const TemporaryFolder over, folder;
  folder.write("quintet/two.glsl", "folder's two");
  over.write("quintet/a/one.glsl", "override's one");
  CompilerOptions options;
  options.includeFolders = {folder.path()};
  const Source source = computeSource("");
  {
    IncludeResolver files(source, options, library);
    const SourceFile* one = files.resolve(files.root(), {"quintet/a/one.glsl", false});
    ASSERT_TRUE(one);
    EXPECT_EQ(one->name, "<quintet/a/one.glsl>");
    const SourceFile* two = files.resolve(*one, {"../two.glsl", true});
    ASSERT_TRUE(two);
    EXPECT_EQ(two->text, "TWO");
    EXPECT_EQ(files.find("<quintet/two.glsl>"), two);
    EXPECT_EQ(files.resolve(*one, {"../../../etc/passwd", true}), nullptr);
    EXPECT_EQ(files.resolve(*one, {"", true}), nullptr);
    EXPECT_EQ(files.resolve(*one, {"quintet", false}), nullptr);
  }
  options.libraryOverride = over.path();
  IncludeResolver files(source, options, library);
  const SourceFile* one = files.resolve(files.root(), {"quintet/a/one.glsl", false});
  ASSERT_TRUE(one);
  EXPECT_EQ(one->text, "override's one");
  const SourceFile* two = files.resolve(*one, {"../two.glsl", true});  // falls back to the embedded file
  ASSERT_TRUE(two);
  EXPECT_EQ(two->text, "TWO");
}

TEST(Include, ReportsWhereAMissingFileWasSearched) {
  const TemporaryFolder folder;
  CompilerOptions options;
  options.includeFolders = {folder.path()};
  const Result result = Compiler(options).compile(
      computeSource("#include \"no/such.glsl\"\nint f() { return fromThere; }", "", "/some/where/m.comp"));
  EXPECT_EQ(result.diagnostics.size(), 2u) << all(result);
  const Diagnostic* error = firstOf(result, Severity::error);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->line, 4);
  EXPECT_NE(error->text.find("no/such.glsl"), std::string::npos) << error->text;
  EXPECT_NE(error->text.find("file not found"), std::string::npos) << error->text;
  const Diagnostic* note = firstOf(result, Severity::note);
  ASSERT_TRUE(note) << all(result);
  EXPECT_NE(note->text.find("/some/where"), std::string::npos) << note->text;
  EXPECT_NE(note->text.find(folder.path().string()), std::string::npos) << note->text;
}

TEST(Include, StaysInTheRootsOfTheEnvironment) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "project/program");
  const auto outside = folder.write("outside.glsl", "int two() { return 2; }\n");
  folder.write("project/inside.glsl", "int two() { return 2; }\n");
  std::filesystem::create_symlink(outside, folder.path() / "project/program/link.glsl");
  const auto compiles = [&](const std::string& include) {
    return Compiler({})
        .compile(computeSource("#include \"" + include + "\"", "b.x = two();",
                               (folder.path() / "project/program/main.comp").string()))
        .ok();
  };
  for (const std::string& include : {std::string("../../outside.glsl"), outside.string(), std::string("link.glsl")}) {
    EXPECT_TRUE(compiles(include)) << include;
    addFileRoot(folder.path() / "project");
    EXPECT_FALSE(compiles(include)) << include;
    EXPECT_TRUE(compiles("../inside.glsl"));
    addFileRoot(folder.path());
    EXPECT_TRUE(compiles(include)) << "of several roots: " << include;
    ::unsetenv("QUINTET_INCLUDE_ROOTS");
  }
}

// A project can be a home folder, and the message of the compiler shows the line of a file that is no GLSL.
TEST(Include, HiddenFilesAreNotRead) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "project/.ssh");
  folder.write("project/.ssh/key", "password\n");
  folder.write("project/.env", "password\n");
  std::filesystem::create_symlink(".env", folder.path() / "project/link.glsl");
  addFileRoot(folder.path() / "project");
  for (const char* include : {".ssh/key", ".env", "./.env", "../project/.env", "link.glsl"}) {
    const Result result = Compiler({}).compile(computeSource(std::string("#include \"") + include + "\"", "b.x = 1;",
                                                             (folder.path() / "project/main.comp").string()));
    EXPECT_FALSE(result.ok()) << include;
    for (const Diagnostic& diagnostic : result.diagnostics)
      EXPECT_EQ(diagnostic.format().find("password"), std::string::npos) << diagnostic.format();
  }
  ::unsetenv("QUINTET_INCLUDE_ROOTS");
}

TEST(Include, ReportsIncludeCycles) {
  Source source = computeSource("#include <a.glsl>");
  source.virtualFiles["a.glsl"] = "#include <b.glsl>\n";
  source.virtualFiles["b.glsl"] = "#include <a.glsl>\n";
  const Result result = Compiler({}).compile(source);
  const Diagnostic* error = firstOf(result, Severity::error);
  ASSERT_TRUE(error);
  EXPECT_NE(error->text.find("<b.glsl> -> <a.glsl> -> <b.glsl> (add include guards)"), std::string::npos)
      << error->text;
}

TEST(Include, AcceptsGuardedCycles) {
  Source source = computeSource("#include <a.glsl>", "b.x = a() + bb();");
  source.virtualFiles["a.glsl"] = "#ifndef A\n#define A\n#include <b.glsl>\nint a() { return 1; }\n#endif\n";
  source.virtualFiles["b.glsl"] = "#ifndef BB\n#define BB\n#include <a.glsl>\nint bb() { return 1; }\n#endif\n";
  const Result result = Compiler({}).compile(source);
  EXPECT_TRUE(result.ok()) << all(result);
}

TEST(Include, RejectsExponentialIncludes) {
  Source source = computeSource("#include <0>");
  for (int k = 0; k < 40; ++k) {
    const std::string next = "#include <" + std::to_string(k + 1) + ">\n";
    source.virtualFiles[std::to_string(k)] = next + next;
  }
  source.virtualFiles["40"] = "\n";
  EXPECT_FALSE(Compiler({}).compile(source).ok());
}

TEST(Include, AcceptsNamesThatNeedEscapesInLineDirectives) {
  const TemporaryFolder folder;
  folder.write("one.glsl", kBroken);
  const std::string name = (folder.path() / "q\"uo\\te\nd.comp").string();
  const Result result =
      Compiler({}).compile(computeSource("#include \"one.glsl\"\nint g() { return missing; }", "", name));
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.diagnostics.at(0).line, 3);
  EXPECT_EQ(result.diagnostics.back().line, 5) << all(result);
}

TEST(Include, FindsDirectivesInAllCommonForms) {
  const auto found = findIncludes(
      "#include <a>\n  #  include \"b\"\n//#include <c>\n#include d\n#include \"e\n#includ <f>\n#include<g>");
  std::vector<std::string> names;
  for (const IncludeDirective& i : found) names.emplace_back(i.name);
  EXPECT_EQ(names, (std::vector<std::string>{"a", "b", "c", "g"}));
  EXPECT_FALSE(found[0].quoted);
  EXPECT_TRUE(found[1].quoted);
}

}  // namespace
}  // namespace quintet::shader
