// SPDX-License-Identifier: Apache-2.0
// Finding and reading programs: folders, files of the lecture form, built-in programs and their short names.
#include "program/load.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "base/file.h"
#include "program/compile.h"
#include "program/program_test_support.h"
#include "temp_folder.h"

namespace quintet::program {
namespace {

TEST(LoadProgram, ReadsAFolder) {
  const test::TempFolder folder;
  const std::filesystem::path path = folder.path() / "mine";
  std::filesystem::create_directories(path);
  EXPECT_THROW(loadProgram(path.string()), FileError);  // program.toml is missing
  writeFile(path / "program.toml", std::string_view(kSmall));
  EXPECT_THROW(loadProgram(path.string()), FileError);  // main.rgen is missing
  writeFile(path / "main.rgen", std::string_view("void main() {}"));
  writeFile(path / "sky.rmiss", std::string_view("void main() {}"));
  for (const std::filesystem::path& name : {path, path / "program.toml"}) {
    const Program p = loadProgram(name.string());
    EXPECT_EQ(p.name, "mine");
    EXPECT_EQ(p.origin, path.string());
    EXPECT_EQ(p.files.at("main.rgen"), "void main() {}");
  }
}

TEST(LoadProgram, ReadsALectureWithWhatItNeeds) {
  const test::TempFolder folder;
  const std::string name = (folder.path() / "one").string();
  writeFile(name + ".rt.glsl",
            std::string_view("#include \"common.glsl\"\nuniform sampler2D wood; // defaultval=\"wood.png\"\n"
                             "void main() { /**** RAY GENERATION SHADER ****/ }\n"));
  writeFile(folder.path() / "common.glsl", std::string_view("#include \"more.glsl\"\n"));
  writeFile(folder.path() / "more.glsl", std::string_view("const int kMore = 1;\n"));
  writeFile(folder.path() / "unused.glsl", std::string_view("const int kUnused = 1;\n"));
  writeFile(folder.path() / "wood.png", std::string_view("not read here"));
  writeFile(folder.path() / "any.scene.toml", std::string_view(""));
  for (const std::string& path : {name, name + ".rt.glsl", folder.path().string()}) {
    const Program p = loadProgram(path);
    EXPECT_TRUE(p.diagnostics.empty()) << path;
    EXPECT_EQ(p.name, "one");
    EXPECT_EQ(p.scene, "any.scene.toml");
    for (const char* file : {"common.glsl", "more.glsl", "wood.png"}) EXPECT_TRUE(p.files.contains(file)) << file;
    EXPECT_FALSE(p.files.contains("unused.glsl"));
  }
  // With a second lecture file, the folder is ambiguous and a scene with its name belongs to it.
  writeFile(folder.path() / "any.rt.glsl", std::string_view("void main() { /**** RAY GENERATION SHADER ****/ }\n"));
  EXPECT_THROW(loadProgram(folder.path().string()), FileError);
  EXPECT_EQ(loadProgram(name).scene, "");
  EXPECT_THROW(loadProgram((folder.path() / "none.rt.glsl").string()), FileError);
}

TEST(LoadProgram, AcceptsShortNamesOfBuiltInPrograms) {
  const std::string full = "lessons/05_shadow";
  const Program program = loadProgram(full);
  for (const char* name : {"05_shadow", "shadow"}) {
    EXPECT_EQ(loadProgram(name).origin, program.origin);
    EXPECT_EQ(loadProgram(name).files, program.files);
  }
  EXPECT_EQ(loadProgram("ao").name, "ao");
  EXPECT_THROW(loadProgram("lessons"), UsageError);
  try {
    loadProgram("shadw");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("'lessons/05_shadow'"), std::string::npos) << error.what();
  }
}

TEST(LoadProgram, FindsABuiltInProgramInBracketsBesideAFolderOfItsName) {
  const test::TempFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::create_directories(folder.path() / "lessons/05_shadow");
  std::filesystem::current_path(folder.path());
  EXPECT_THROW(loadProgram("lessons/05_shadow"), FileError);  // the folder is empty
  const Program program = loadProgram("<programs/lessons/05_shadow>");
  std::filesystem::current_path(before);
  EXPECT_EQ(program.name, "lessons/05_shadow");
  EXPECT_EQ(program.origin, "<programs/lessons/05_shadow>");
  EXPECT_EQ(loadProgram("<programs/ao>").name, "ao");
  EXPECT_THROW(loadProgram("<programs/shadow>"), UsageError);
  EXPECT_THROW(loadProgram("<programs/>"), UsageError);
}

TEST(LoadProgram, SuggestsTheNearestBuiltInProgram) {
  try {
    loadProgram("pathtrace");
    FAIL();
  } catch (const UsageError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("'pathtrace'"), std::string::npos) << text;
    EXPECT_NE(text.find("'pathtracer'"), std::string::npos) << text;
  }
  EXPECT_THROW(loadProgram(""), UsageError);
  EXPECT_THROW(loadProgram("no/such/folder"), UsageError);
}

TEST(BuiltInPrograms, IncludeThoseOfTheDocumentation) {
  EXPECT_THAT(builtInPrograms(), testing::IsSupersetOf({"ao", "naive", "normals", "pathtracer"}));
}

TEST(BuiltInPrograms, ParseAndCompile) {
  shader::CompilerOptions options;
  options.cacheFolder = cacheFolder() / "shaders";  // shared with CheckBuiltIn
  const shader::Compiler compiler{options};
  for (const std::string& name : builtInPrograms()) {
    SCOPED_TRACE(name);
    const Program p = loadProgram(name);
    EXPECT_EQ(p.name, name);
    EXPECT_EQ(p.origin, "<programs/" + name + ">");
    const bool isLecture = p.accumulation == Accumulation::program;
    EXPECT_FALSE(p.description.empty());
    ASSERT_FALSE(p.outputs.empty());
    EXPECT_EQ(p.outputs[0].name, isLecture ? "image" : "color");
    for (const Parameter& parameter : p.parameters) EXPECT_FALSE(parameter.help.empty()) << parameter.name;
    // Both ways to get the barycentrics of a hit (a scene with alpha defines the second), for programs that use them.
    const bool usesBarycentrics = !isLecture || std::ranges::any_of(p.files, [](const auto& file) {
      return file.second.find("baryCoord") != std::string::npos;
    });
    for (const std::vector<std::pair<std::string, std::string>>& defines :
         {std::vector<std::pair<std::string, std::string>>{}, {{"QUINTET_RECOMPUTE_BARYCENTRICS", "1"}}}) {
      if (!defines.empty() && !usesBarycentrics) continue;
      const CompiledProgram compiled = compile(p, compiler, defines);
      EXPECT_TRUE(compiled.ok);
      for (const Diagnostic& d : compiled.diagnostics) ADD_FAILURE() << d.format();
    }
  }
}

}  // namespace
}  // namespace quintet::program
