// SPDX-License-Identifier: Apache-2.0
// What the tables of options give: help, man pages, completions of shells, and errors of the command line.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>

#include <gmock/gmock.h>

#include "base/parse.h"
#include "base/wrap.h"
#include "fixtures.h"

namespace quintet::test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::Not;

class Help : public CliTest {
 protected:
  std::vector<std::string> commandNames() {
    std::vector<std::string> names = splitText(quintet({"help", "--commands"}).out, '\n');
    names.pop_back();
    return names;
  }
  // The names of a command's options, as its help lists them: "-o", "--output".
  std::vector<std::string> optionNames(const std::string& command) {
    std::vector<std::string> names;
    for (const std::string& line : splitText(quintet({command, "--help"}).out, '\n')) {
      if (!line.starts_with("  -")) continue;
      for (std::string part : splitText(line.substr(2), ',')) {
        part.erase(0, part.find_first_not_of(' '));
        if (!part.starts_with('-')) break;
        names.push_back(part.substr(0, part.find_first_of(" [")));
        if (part.find_first_of(" [") != part.npos) break;
      }
    }
    return names;
  }
  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  // Output of a shell command in the test's folder; fails the test if its status is not 0.
  std::string shell(const std::string& command) {
    const std::string line = "cd '" + folder_.path().string() + "' && (" + command + ") 2>&1";
    FILE* pipe = ::popen(line.c_str(), "r");
    std::string text;
    std::array<char, 4096> buffer{};
    while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe)) text.append(buffer.data(), got);
    EXPECT_EQ(::pclose(pipe), 0) << command << "\n" << text;
    return text;
  }
  static bool has(const std::string& program) {
    return std::system(("command -v " + program + " > /dev/null").c_str()) == 0;
  }
};

TEST_F(Help, OfACommandIsThatOfItsOption) {
  for (const std::string& command : commandNames()) {
    const RunResult help = quintet({"help", command});
    EXPECT_EQ(help.status, 0);
    EXPECT_EQ(help.out, quintet({command, "--help"}).out) << command;
  }
  EXPECT_EQ(quintet({"help"}).out, quintet({"--help"}).out);
  expectError(quintet({"help", "rendr"}), 2, {"unknown command 'rendr'", "'render'"});
  expectError(quintet({"help", "--completion", "bsh"}), 2, {"--completion", "'bsh'", "'bash'"});
  expectError(quintet({"help", "--man", "--commands"}), 2, {"exclude"});
}

TEST_F(Help, FitsInto80Columns) {
  std::vector<std::string> texts{quintet({"--help"}).out};
  for (const std::string& command : commandNames()) texts.push_back(quintet({command, "--help"}).out);
  for (const std::string& text : texts)
    for (const std::string& line : splitText(text, '\n')) EXPECT_LE(columnsOf(line), 80u) << line;
}

// A terminal gets lines that break between words; files and pipes get one line.
TEST_F(Help, ErrorsBreakBetweenWords) {
  const std::vector<std::string> arguments{"render", "a", "--tonemap", "a-name-that-is-rather-long"};
  const std::string line = quintet(arguments).err;
  EXPECT_EQ(std::ranges::count(line, '\n'), 1);
  std::string shown = TerminalRun(arguments, folder_.path(), 60).finish().err;
  std::erase(shown, '\r');
  EXPECT_GT(std::ranges::count(shown, '\n'), 1);
  std::string joined;
  for (const std::string& part : splitText(shown, '\n')) {
    EXPECT_LE(columnsOf(part), 60u);
    joined +=
        (joined.empty() || part.empty() ? "" : " ") + part.substr(std::min(part.find_first_not_of(' '), part.size()));
  }
  EXPECT_EQ(joined + "\n", line);
}

TEST_F(Help, MissingValuesAreNamed) {
  expectError(quintet({"render", "scene.gltf", "--spp"}), 2,
              {"--spp: the value N is missing", "quintet render --help"});
  expectError(quintet({"render", "scene.gltf", "-o"}), 2, {"--output: the value FILE is missing"});
  expectError(quintet({"info", "--json=no"}), 2, {"--json: this option takes no value"});
  expectError(quintet({"bench"}), 2, {"no scene or program given"});
  expectError(quintet({"render", "--size=", "3x3"}), 2, {"--size: the value is empty"});
  expectError(quintet({"bench", "scene.gltf", "--repeat", "0"}), 2, {"--repeat", "[1, 1000]"});
  expectError(quintet({"bench", "scene.gltf", "--repeat", "1.5"}), 2, {"--repeat", "integer"});
}

// A script that passes its arguments on can append options to its own.
TEST_F(Help, TheLastOccurrenceOfAnOptionCounts) {
  const RunResult result =
      quintet({"render",     "scene.gltf", "--program", "ao", "--program", "normals",  "--spp",   "64",
               "--spp",      "",           "--spp",     "4",  "--size",    "9x9",      "-q",      "-q",
               "--size=8x6", "--json",     "--json",    "-o", "first.png", "--output", "last.png"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["program"], "normals");
  EXPECT_EQ(json["samples"], 4);
  EXPECT_EQ(json["files"], nlohmann::json{"last.png"});
  EXPECT_EQ(readImage("last.png").width, 8u);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "first.png"));
  expectError(quintet({"render", "scene.gltf", "--spp", "4", "--spp", "four"}), 2, {"--spp", "'four'"});
  expectError(quintet({"bench", "scene.gltf", "--repeat", "1", "--repeat", "0"}), 2, {"--repeat", "[1, 1000]"});
  // Lists collect all values, so the unknown one is noticed.
  expectError(quintet({"render", "scene.gltf", "--set", "nonsense=1", "--set", "bounces=2"}), 2, {"'nonsense'"});
}

TEST_F(Help, TwoDashesEndTheOptions) {
  std::filesystem::rename(folder_ / "scene.gltf", folder_ / "-scene.gltf");
  EXPECT_THAT(quintet({"info", "--", "-scene.gltf"}).out, HasSubstr("-scene.gltf: "));
  expectError(quintet({"info", "-scene.gltf"}), 2, {"unknown option"});
  expectError(quintet({"info", "--", "-scene.gltf", "--json"}), 2, {"unexpected argument '--json'"});
  expectError(quintet({"run", "--", "--help"}), 2, {"--help"});
}

// Options may stand between the values of a list.
TEST_F(Help, ListsOfArguments) {
  expectError(quintet({"merge", "a.qfilm", "b.qfilm", "-o", "c.png", "d.qfilm"}), 1, {"a.qfilm: cannot be read"});
}

TEST_F(Help, ListOfProgramsIsComplete) {
  const std::string piped = quintet({"run", "--list"}).out;
  EXPECT_THAT(piped, Not(HasSubstr("...")));
  EXPECT_TRUE(std::ranges::any_of(splitText(piped, '\n'), [](const std::string& l) { return l.size() > 110; }));
}

TEST_F(Help, ColumnsOfProgramsDoNotCollide) {
  write("long.rt.glsl",
        shell(std::string(QUINTET_BINARY) + " new first > /dev/null && sed "
                                            "'s/lampDirection/aVeryLongNameOfAParameter/g' first.rt.glsl"));
  const std::string text = quintet({"run", "long.rt.glsl", "--help"}).out;
  EXPECT_THAT(text, HasSubstr("aVeryLongNameOfAParameter  Direction to the lamp"));
}

TEST_F(Help, ManPagesHaveEveryOption) {
  for (const std::string& command : commandNames()) {
    const std::string page = quintet({"help", "--man", command}).out;
    EXPECT_THAT(page, AllOf(HasSubstr(".TH QUINTET-"), HasSubstr(".SH NAME"), HasSubstr(".SH OPTIONS")));
    EXPECT_FALSE(optionNames(command).empty());
    for (std::string name : optionNames(command)) {
      for (std::size_t at = name.find('-'); at != name.npos; at = name.find('-', at + 2)) name.replace(at, 1, "\\-");
      EXPECT_THAT(page, HasSubstr("\\fB" + name + "\\fR")) << command;
    }
  }
  const std::string main = quintet({"help", "--man"}).out;
  for (std::string command : commandNames()) {
    for (std::size_t at = command.find('-'); at != command.npos; at = command.find('-', at + 2))
      command.replace(at, 1, "\\-");
    EXPECT_THAT(main, HasSubstr(".BR quintet\\-" + command + " (1)"));
  }
}

// The first column of the first table in docs/cli.md after `heading`: "130, 143", "QUINTET_DEVICE".
std::vector<std::string> rowsOfDocs(const std::string& heading) {
  std::ifstream file(QUINTET_SOURCE_ROOT "/docs/cli.md");
  std::vector<std::string> rows;
  std::string line;
  while (std::getline(file, line) && line != "## " + heading) {
  }
  while (std::getline(file, line) && !line.starts_with("| ---")) {
  }
  while (std::getline(file, line) && line.starts_with("| ")) {
    std::string cell = line.substr(2, line.find(" |", 2) - 2);
    std::erase(cell, '`');
    rows.push_back(cell.substr(0, cell.find('=')));
  }
  return rows;
}

TEST_F(Help, TheManPageHasTheTablesOfTheDocumentation) {
  const std::string page = quintet({"help", "--man"}).out;
  const auto rowsOfPage = [&](const std::string& section) {
    std::vector<std::string> rows;
    const std::size_t begin = page.find(".SH " + section);
    for (const std::string& line : splitText(page.substr(begin, page.find(".SH", begin + 1) - begin), '\n'))
      if (line.starts_with(".B ")) rows.push_back(line.substr(3));
    return rows;
  };
  EXPECT_THAT(rowsOfPage("EXIT STATUS"), ElementsAreArray(rowsOfDocs("Output, errors and exit status")));
  EXPECT_THAT(rowsOfPage("EXIT STATUS"), Contains("137"));
  EXPECT_THAT(rowsOfPage("ENVIRONMENT"), ElementsAreArray(rowsOfDocs("Environment variables")));
}

TEST_F(Help, ManPagesAreValid) {
  if (!has("groff")) GTEST_SKIP() << "groff is missing";
  std::vector<std::string> pages{quintet({"help", "--man"}).out};
  for (const std::string& command : commandNames()) pages.push_back(quintet({"help", "--man", command}).out);
  for (const std::string& page : pages) {
    write("page.1", page);
    EXPECT_EQ(shell("groff -man -ww -z -Tutf8 -Kutf8 page.1"), "");
    EXPECT_THAT(shell("groff -man -Tutf8 -Kutf8 -P-c page.1"), Not(HasSubstr("\\")));
  }
}

TEST_F(Help, CompletionsHaveEveryOption) {
  const std::string bash = quintet({"help", "--completion", "bash"}).out;
  const std::string zsh = quintet({"help", "--completion", "zsh"}).out;
  const std::string fish = quintet({"help", "--completion", "fish"}).out;
  for (const std::string& command : commandNames()) {
    const std::string inBash = bash.substr(bash.find("    " + command + ")\n"));
    const std::string inZsh = zsh.substr(zsh.find("_quintet_" + command + "() {"));
    for (const std::string& name : optionNames(command)) {
      EXPECT_THAT(inBash.substr(0, inBash.find("\n      ;;")), HasSubstr(name)) << command;
      EXPECT_THAT(inZsh.substr(0, inZsh.find("\n}")), HasSubstr(name)) << command;
      // "farm-plan" is "farm plan" on a command line.
      const bool isOfGroup = command.starts_with("farm-");
      const std::string words = isOfGroup ? "farm; and __fish_seen_subcommand_from " + command.substr(5) : command;
      const std::string inFish = name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      EXPECT_TRUE(std::ranges::any_of(splitText(fish, '\n'),
                                      [&](const std::string& line) {
                                        return line.find("seen_subcommand_from " + words + "'") != line.npos &&
                                               (line + " ").find(inFish + " ") != line.npos;
                                      }))
          << command << name;
    }
  }
}

class Completion : public Help, public testing::WithParamInterface<const char*> {};

TEST_P(Completion, IsValid) {
  const std::string name = GetParam();
  if (!has(name)) GTEST_SKIP() << name << " is missing";
  write(name, quintet({"help", "--completion", name}).out);
  EXPECT_EQ(shell(name + " -n ./" + name), "");
}
INSTANTIATE_TEST_SUITE_P(Shells, Completion, testing::Values("bash", "zsh", "fish"),
                         [](const auto& shell) { return std::string(shell.param); });

class BashCompletion : public Help {
 protected:
  void SetUp() override {
    Help::SetUp();
    if (!has("bash")) GTEST_SKIP() << "bash is missing";
    write("completion", quintet({"help", "--completion", "bash"}).out);
  }
  // What bash offers after these words.
  std::vector<std::string> complete(const std::string& words) {
    std::vector<std::string> found =
        splitText(shell("bash -c 'source ./completion; COMP_WORDS=(" + words +
                        "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _quintet; printf \"%s\\n\" \"${COMPREPLY[@]}\"'"),
                  '\n');
    std::erase(found, "");
    std::ranges::sort(found);
    return found;
  }
};

TEST_F(BashCompletion, Names) {
  EXPECT_THAT(complete("quintet ren"), ElementsAre("render"));
  std::set<std::string> words;
  for (const std::string& name : commandNames()) words.insert(name.starts_with("farm-") ? "farm" : name);
  EXPECT_EQ(complete("quintet \"\"").size(), words.size());
  EXPECT_THAT(complete("quintet farm \"\""), ElementsAre("merge", "plan", "run", "status"));
  EXPECT_THAT(complete("quintet farm plan --part"), ElementsAre("--partition", "--parts"));
  EXPECT_THAT(complete("quintet --v"), ElementsAre("--version"));
  EXPECT_THAT(complete("quintet render --ou"), ElementsAre("--output"));
  EXPECT_THAT(complete("quintet render scene.gltf --until"), ElementsAre("--until-error"));
  EXPECT_THAT(complete("quintet help exp"), ElementsAre("explain", "explain-pixel"));
}

TEST_F(BashCompletion, ValuesAndFiles) {
  write("a.glb", "");
  write("b.png", "");
  write("c.txt", "");
  write("-d.glb", "");
  std::filesystem::create_directory(folder_ / "folder");
  EXPECT_THAT(complete("quintet render --tonemap a"), ElementsAre("aces", "agx"));
  EXPECT_THAT(complete("quintet render --tonemap = ag"), ElementsAre("agx"));
  EXPECT_THAT(complete("quintet render \"\""), ElementsAre("-d.glb", "a.glb", "folder", "scene.gltf"));
  EXPECT_THAT(complete("quintet render -- -"), ElementsAre("-d.glb"));
  EXPECT_THAT(complete("quintet render a.glb -o \"\""), ElementsAre("b.png", "folder"));
  EXPECT_THAT(complete("quintet run pathtr"), ElementsAre("pathtracer"));
  EXPECT_TRUE(complete("quintet render a.glb --spp \"\"").empty());
}

// The ids of the diagnostics that `quintet explain` lists, in order.
std::string idsIn(const std::string& list) {
  std::string ids;
  for (const std::string& line : splitText(list, '\n'))
    if (!line.empty()) ids += (ids.empty() ? "" : " ") + line.substr(0, line.find(' '));
  return ids;
}

// The diagnostics about the topic, by title and keywords. Those that only mention it are listed if there are no others.
TEST_F(Help, ExplainsTopics) {
  const RunResult several = quintet({"explain", "payload"});
  EXPECT_EQ(several.status, 0);
  EXPECT_EQ(idsIn(several.out), "Q101 Q102 Q103 Q104 Q105 Q106 Q107");
  EXPECT_EQ(quintet({"explain", "PAYLOADS"}).out, several.out);
  for (const auto& [topic, ids] : std::map<std::string, std::string>{{"recursion", "Q003 Q401 Q402 Q403 Q667"},
                                                                     {"mask", "Q505 Q507"},
                                                                     {"normal", "Q702 Q709"},
                                                                     {"nan", "Q001 Q002 Q509 Q510"},
                                                                     {"shadow acne", "Q005 Q705"},
                                                                     {"q65", "Q651 Q652 Q653 Q654"}})
    EXPECT_EQ(idsIn(quintet({"explain", topic}).out), ids) << topic;
  const std::string table = quintet({"explain", "shader", "binding", "table"}).out;
  EXPECT_THAT(idsIn(table), HasSubstr("Q501 Q502 Q503 Q504"));
  EXPECT_EQ(quintet({"explain", "sbt"}).out, table);
  EXPECT_THAT(idsIn(quintet({"explain", "crash"}).out), HasSubstr("Q651")) << "only mentioned";
  expectError(quintet({"explain", "?"}), 2, {"unknown diagnostic '?'"});
  EXPECT_THAT(quintet({"explain", "nested", "incoming", "payload"}).out, HasSubstr("Q105"));
  EXPECT_GT(nlohmann::json::parse(quintet({"explain", "payload", "--json"}).out).size(), 1u);
  expectError(quintet({"explain", "flying saucers"}), 2, {"unknown diagnostic 'flying saucers'"});
  // A topic that one title has alone prints the page.
  const std::string page = quintet({"explain", "Q101"}).out;
  const std::string title = page.substr(page.find("Q101"), page.find('\n') - page.find("Q101"));
  EXPECT_EQ(quintet({"explain", title.substr(title.find_first_of(": ") + 2)}).out.substr(0, 4), page.substr(0, 4));
}

TEST_F(Help, TypographicQuotes) {
  expectError(quintet({"render", "“scene.gltf”"}), 1, {"“scene.gltf”", "“ is a typographic quote; type \" instead"});
  expectError(quintet({"render", "scene.gltf", "--tonemap", "‘aces’"}), 2,
              {"‘ is a typographic quote; type ' instead"});
  ASSERT_EQ(quintet({"new", "first"}).status, 0);
  for (const char* quote : {"“", "”", "‘", "’"}) {
    write("bad.rt.glsl", shell(std::string("sed '0,/vec3(/s//vec3(") + quote + "/' first.rt.glsl"));
    const RunResult result = quintet({"check", "bad.rt.glsl", "--device", "none"});
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, AllOf(HasSubstr(std::string("'") + quote + "' : unexpected token; " + quote +
                                            " is a typographic quote"),
                                  HasSubstr("^")));
  }
}

}  // namespace
}  // namespace quintet::test
