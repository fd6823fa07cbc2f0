// SPDX-License-Identifier: Apache-2.0
// The format of the cases of the corpus (tests/check/README.md).
#include "case_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "temp_folder.h"

namespace quintet::test {
namespace {

using testing::ElementsAre;
using testing::Pair;

const CaseFiles kDefaults{{"payload.glsl", "P\n"}, {"sky.rmiss", "#include \"payload.glsl\"\n"}};

std::string fixedText(const std::string& lines) {
  return parseCase("//--- a.rgen\n" + lines, "demo").fixed.at("a.rgen");
}

std::string errorOf(const std::string& text) {
  try {
    parseCase(text, "demo", kDefaults);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(CaseFile, SectionsAreFiles) {
  const Case program = parseCase("//--- a.rgen\nx\n\ny\n//--- empty.glsl\n//--- b.rmiss\nz\n", "demo");
  EXPECT_EQ(program.name, "demo");
  EXPECT_THAT(program.files, ElementsAre(Pair("a.rgen", "x\n\ny\n"), Pair("b.rmiss", "z\n"), Pair("empty.glsl", "")));
  EXPECT_TRUE(program.fixed.empty());
  EXPECT_EQ(program.allFixed(), program.files);
}

TEST(CaseFile, FixesChangeTheLineBefore) {
  EXPECT_EQ(fixedText("x\n  // FIX: y  + 1\nz\n"), "  y  + 1\nz\n");
  EXPECT_EQ(fixedText("x\nz\n// FIX-DELETE\n"), "x\n");
  EXPECT_EQ(fixedText("x\ny\nz\n// FIX-DELETE 2\n"), "x\n");
  EXPECT_EQ(fixedText("x\n\t// FIX-INSERT: y\n"), "x\n\ty\n");
  EXPECT_EQ(fixedText("// FIX-INSERT: first\nx\n"), "first\nx\n");
  EXPECT_EQ(fixedText("x\n// FIX: y\n// FIX-INSERT: z\n"), "y\nz\n");
  EXPECT_EQ(fixedText("x\ny\n# FIX-DELETE 2\n# FIX-INSERT: z = 1\n"), "z = 1\n");
  EXPECT_EQ(fixedText("x\n  // FIX:\n  // FIX-INSERT:\n"), "\n\n");
}

TEST(CaseFile, MarksAreNotInTheFiles) {
  const Case program = parseCase("//--- a.rgen\nx\n// FIX: y\nz\n// FIX-INSERT: w\n", "demo");
  EXPECT_EQ(program.files.at("a.rgen"), "x\nz\n");
  EXPECT_EQ(program.fixed.at("a.rgen"), "y\nz\nw\n");
  EXPECT_EQ(program.allFixed().at("a.rgen"), "y\nz\nw\n");
}

// Other comments are text.
TEST(CaseFile, OnlyWholeCommentsAreFixes) {
  const std::string text = "x;  // FIX: y\n// FIXED: y\n// A FIX: y\n//FIX: y\n";
  const Case program = parseCase("//--- a.rgen\n" + text, "demo");
  EXPECT_EQ(program.files.at("a.rgen"), text);
  EXPECT_TRUE(program.fixed.empty());
}

TEST(CaseFile, RepairedVersionsHaveNoExpectations) {
  const std::string lines = "x;  // EXPECT Q101\n  // EXPECT+1 Q102\ny\nz  # EXPECT Q103\n";
  const Case program = parseCase("//--- a.rgen\n" + lines, "demo");
  EXPECT_EQ(program.files.at("a.rgen"), lines);
  EXPECT_EQ(program.fixed.at("a.rgen"), "x;\ny\nz\n");
  EXPECT_EQ(fixedText("x;  // EXPECT Q101\n// FIX: y;\n"), "y;\n");
  EXPECT_EQ(fixedText("w\n// EXPECT+1 Q101\nx\ny\n// FIX-DELETE 3\n"), "");  // the mark is no line of this version
}

TEST(CaseFile, RepairedSectionsReplaceFiles) {
  const Case program =
      parseCase("//--- a.rgen\nx  // EXPECT Q101\n//--- repaired/a.rgen\ny\n//--- repaired/new.rint\nz\n", "demo");
  EXPECT_THAT(program.files, ElementsAre(Pair("a.rgen", "x  // EXPECT Q101\n")));
  EXPECT_THAT(program.fixed, ElementsAre(Pair("a.rgen", "y\n"), Pair("new.rint", "z\n")));
}

TEST(CaseFile, NamedDefaultFilesBelongToTheCase) {
  const Case program = parseCase("//--- program.toml\nmiss = \"sky.rmiss\"\n", "demo", kDefaults);
  EXPECT_THAT(program.files, ElementsAre(Pair("payload.glsl", "P\n"), Pair("program.toml", testing::_),
                                         Pair("sky.rmiss", kDefaults.at("sky.rmiss"))));
  const Case own = parseCase("//--- program.toml\nmiss = \"sky.rmiss\"\n//--- sky.rmiss\nown\n", "demo", kDefaults);
  EXPECT_THAT(own.files, ElementsAre(Pair("program.toml", testing::_), Pair("sky.rmiss", "own\n")));
  const Case without =
      parseCase("//--- without sky.rmiss\n//--- program.toml\nmiss = \"sky.rmiss\"\n", "demo", kDefaults);
  EXPECT_THAT(without.files, ElementsAre(Pair("program.toml", testing::_)));
  EXPECT_THAT(parseCase("//--- a.rgen\nsky.rmiss\n", "demo", kDefaults).files, ElementsAre(Pair("a.rgen", testing::_)));
}

TEST(CaseFile, LinesHaveTheirLocations) {
  const Case program = parseCase("//--- a.toml\n\"sky.rmiss\"\n//--- b.rgen\nx\n// FIX: y\nz\n", "demo", kDefaults);
  EXPECT_EQ(program.locationOf("a.toml", 1), "demo.case:2");
  EXPECT_EQ(program.locationOf("b.rgen", 2), "demo.case:6");
  for (const int line : {0, 3}) EXPECT_EQ(program.locationOf("b.rgen", line), "");
  EXPECT_EQ(program.locationOf("sky.rmiss", 1), "");
}

TEST(CaseFile, ErrorsHaveALine) {
  const std::string start = "//--- a.rgen\nx\n";
  EXPECT_EQ(errorOf(""), "demo.case:1: the case has no section");
  EXPECT_EQ(errorOf("x\n"), "demo.case:1: this line is in no section; a section starts with '//--- NAME'");
  EXPECT_EQ(errorOf("//--- a.rgen\nx"), "demo.case:2: the last line does not end with a line break");
  for (const std::string name : {"", "../a", "sub/a.rgen", "a b", "repaired/", ".hidden"})
    EXPECT_EQ(errorOf(start + "//--- " + name + "\n"), "demo.case:3: '" + name + "' is not the name of a file");
  EXPECT_EQ(errorOf(start + "//--- a.rgen\n"), "demo.case:3: the section 'a.rgen' already exists");
  EXPECT_EQ(errorOf(start + "//--- repaired/a.rgen\nx\n"),
            "demo.case:3: the repaired version is equal to the section 'a.rgen'");
  EXPECT_EQ(errorOf(start + "//--- repaired/a.rgen\ny\n// FIX: z\n"),
            "demo.case:5: a repaired section cannot have FIX marks");
  EXPECT_EQ(errorOf(start + "// FIX: y\n//--- repaired/a.rgen\nz\n"), "demo.case:4: 'a.rgen' has FIX marks, too");
}

TEST(CaseFile, ErrorsOfFixesHaveALine) {
  const std::string start = "//--- a.rgen\nx\n";
  for (const std::string mark :
       {"FIX", "FIX y", "FIX-DELETE:", "FIX-DELETE 0", "FIX-DELETE 2x", "FIX-INSERT", "FIX-MOVE: y"})
    EXPECT_EQ(errorOf(start + "// " + mark + "\n"),
              "demo.case:3: unknown mark; write 'FIX: text', 'FIX-INSERT: text', 'FIX-DELETE' or 'FIX-DELETE COUNT'");
  EXPECT_EQ(errorOf("//--- a.rgen\n// FIX: y\n"), "demo.case:2: the section has too few lines before the mark");
  EXPECT_EQ(errorOf(start + "// FIX-DELETE 2\n"), "demo.case:3: the section has too few lines before the mark");
  EXPECT_EQ(errorOf(start + "// FIX: y\n// FIX: z\n"), "demo.case:4: a fix cannot change a line that another fix adds");
  EXPECT_EQ(errorOf(start + "// EXPECT+1 Q101\n// FIX: y\nz\n"),
            "demo.case:4: the line before is an EXPECT mark; a fix follows the line that it changes");
}

TEST(CaseFile, ErrorsOfDefaultFilesHaveALine) {
  EXPECT_EQ(errorOf("//--- without a.rgen\n"), "demo.case:1: 'a.rgen' is not a default file");
  EXPECT_EQ(errorOf("//--- without sky.rmiss\n//--- a.rgen\n"),
            "demo.case:1: no file of the case names 'sky.rmiss': remove this line");
  EXPECT_EQ(errorOf("//--- without sky.rmiss\n//--- sky.rmiss\n"), "demo.case:1: the case has a section 'sky.rmiss'");
  EXPECT_EQ(errorOf("//--- without sky.rmiss\nx\n"),
            "demo.case:2: this line is in no section; a section starts with '//--- NAME'");
}

TEST(CaseFile, IsReadAndWritten) {
  const TempFolder folder;
  for (const char* name : {"default", "mistakes"}) std::filesystem::create_directories(folder / name);
  writeFile(folder / "default/sky.rmiss", "sky\n");
  writeFile(folder / "mistakes/b.case", "//--- a.rgen\n\"sky.rmiss\"\n// FIX-DELETE\n");
  writeFile(folder / "mistakes/a.case", "//--- a.rgen\nx\n");
  writeFile(folder / "mistakes/notes.txt", "no case\n");
  EXPECT_THAT(casesIn(folder / "mistakes"), ElementsAre(folder / "mistakes/a.case", folder / "mistakes/b.case"));
  writeCase(readCase(folder / "mistakes/b.case"), folder / "out/b");
  EXPECT_EQ(readTextFile(folder / "out/b/a.rgen"), "\"sky.rmiss\"\n");
  EXPECT_EQ(readTextFile(folder / "out/b/sky.rmiss"), "sky\n");
  EXPECT_EQ(readTextFile(folder / "out/b/repaired/a.rgen"), "");
  writeCase(readCase(folder / "mistakes/a.case"), folder / "out/a");
  EXPECT_FALSE(std::filesystem::exists(folder / "out/a/repaired"));
}

}  // namespace
}  // namespace quintet::test
