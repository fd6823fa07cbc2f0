// SPDX-License-Identifier: Apache-2.0
// The corpus of mistakes (tests/check/mistakes): each program has exactly one mistake, which is reported in the marked
// line, and its repaired version has none. The corpus of idioms (tests/check/idioms): unusual but correct programs, for
// which nothing is reported. The device of these tests has all defects of docs/design/quirks.md. tests/check/README.md describes
// the format of the cases.
//
// tests/check/known_misses.txt and known_false_alarms.txt list the programs for which the check is wrong today. The
// tests fail if a listed program is reported correctly, so the lists stay true. tests/check/messages.txt has the messages, so that
// a wrong number or name in one is noticed. tests/check/update_known writes all three.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "base/file.h"
#include "base/toml_reader.h"
#include "case_file.h"
#include "check/catalog.h"
#include "check_test_support.h"
#include "program/lecture/lecture.h"

namespace quintet::check {
namespace {

namespace fs = std::filesystem;

const fs::path kCheck = fs::path(QUINTET_SOURCE_ROOT) / "tests/check";
const fs::path kMistakes = kCheck / "mistakes";
const fs::path kIdioms = kCheck / "idioms";

std::vector<std::string> namesOfCases(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::path& file : test::casesIn(folder)) names.push_back(file.stem());
  return names;
}

test::Case caseOf(const fs::path& folder, const std::string& name) { return test::readCase(folder / (name + ".case")); }

// The names in a list: the first word of each line that is not empty and no comment.
std::set<std::string> namesIn(const char* list) {
  std::istringstream lines(readTextFile(kCheck / list));
  std::set<std::string> names;
  for (std::string line, name; std::getline(lines, line);)
    if (std::istringstream(line) >> name && name.front() != '#') names.insert(name);
  return names;
}

// facts.toml: [[geometry]] kind, alpha, name, material; [[instance]] name, first, count, mask, force_opaque,
// custom_index.
std::optional<program::SceneFacts> factsOf(const Files& files) {
  const auto found = files.find("facts.toml");
  if (found == files.end()) return {};
  const TomlValue table = parseToml(found->second, "facts.toml");
  TomlReader root(table, "facts.toml", "facts.toml");
  program::SceneFacts facts{"scene.toml", {}, {}};
  constexpr std::string_view kKinds[] = {"triangles", "solids", "csg", "custom"};
  for (const TomlValue& node : root.tables("geometry")) {
    TomlReader g(node, "[[geometry]]", root.file());
    const std::string kind = g.text("kind");
    const auto at = std::ranges::find(kKinds, kind);
    EXPECT_NE(at, std::end(kKinds)) << kind;
    facts.geometries.push_back({static_cast<program::GeometryKind>(at - std::begin(kKinds)), g.boolean("alpha"),
                                g.text("name"), g.text("material")});
    g.rejectUnknownKeys();
  }
  for (const TomlValue& node : root.tables("instance")) {
    TomlReader i(node, "[[instance]]", root.file());
    facts.instances.push_back({i.text("name"), i.integer("first", 0, 0, 1000), i.integer("count", 1, 0, 1000),
                               i.integer("mask", 0xFF, 0, 0xFF), i.boolean("force_opaque"), false,
                               i.integer("custom_index", 0, 0, 0xFFFFFF)});
    i.rejectUnknownKeys();
  }
  root.rejectUnknownKeys();
  return facts;
}

// Returns "Q101 main.rgen:12" for each mark: "EXPECT Q101" marks its own line, "EXPECT+1 Q101" the next line.
std::set<std::string> expectedOf(const Files& files) {
  static const std::regex kMark("EXPECT(\\+1)? (Q[0-9]{3})");
  std::set<std::string> result;
  for (const auto& [name, text] : files) {
    std::istringstream lines(text);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
      std::smatch match;
      if (std::regex_search(line, match, kMark))
        result.insert(fmt::format("{} {}:{}", match[2].str(), name, number + (match[1].matched ? 1 : 0)));
    }
  }
  return result;
}

// The lines of messages.txt for a program: its name, a tab, and a message with its notes.
std::vector<std::string> expectedMessages(const std::string& program) {
  std::istringstream lines(readTextFile(kCheck / "messages.txt"));
  std::vector<std::string> result;
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(program + '\t')) result.push_back(line);
  return result;
}

std::vector<std::string> messagesOf(const std::string& program, const std::vector<Diagnostic>& diagnostics) {
  std::vector<std::string> result;
  for (const Diagnostic& d : diagnostics) {
    std::string& line = result.emplace_back(program + '\t' + d.text);
    for (const auto& note : d.related) line += " | " + note.text;
    std::ranges::replace(line, '\n', ' ');
    static const std::regex kFolder("[^ '(\t]*/([A-Za-z0-9_.]+:[0-9])");
    line = std::regex_replace(line, kFolder, "$1");
  }
  std::ranges::sort(result);  // as in messages.txt, where a message of several stages is one line
  const auto repeated = std::ranges::unique(result);
  result.erase(repeated.begin(), repeated.end());
  return result;
}

CheckResult checkProgram(const Files& files) {
  DeviceLimits limits;
  limits.defects.changesNestedBuiltIns = limits.defects.corruptsHitAttributes = true;
  limits.defects.sharesAnyHit = limits.defects.sharesLocalArrays = true;
  const std::optional<program::SceneFacts> facts = factsOf(files);
  const auto lecture = files.find("program.rt.glsl");
  if (lecture == files.end()) return checkFiles(files, facts ? &*facts : nullptr, limits);
  return check(program::parseLecture(lecture->second, lecture->first, "folder/demo"), checkCompiler(),
               facts ? &*facts : nullptr, limits);
}

// Checked once for all tests of this process.
const CheckResult& checkMistake(const std::string& name) {
  static std::map<std::string, CheckResult> results;
  if (const auto known = results.find(name); known != results.end()) return known->second;
  return results.emplace(name, checkProgram(caseOf(kMistakes, name).files)).first->second;
}

// "Q101 main.rgen:12 is in Q101_payload_type_differs.case:31" for each line.
std::string locationsOf(const test::Case& program, const std::set<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) {
    const std::size_t colon = line.rfind(':');
    const std::string location = program.locationOf(line.substr(5, colon - 5), std::stoi(line.substr(colon + 1)));
    if (!location.empty()) text += line + " is in " + location + '\n';
  }
  return text;
}

class Mistakes : public testing::TestWithParam<std::string> {};

TEST_P(Mistakes, AreReportedInTheMarkedLines) {
  const test::Case program = caseOf(kMistakes, GetParam());
  const std::set<std::string> expected = expectedOf(program.files);
  ASSERT_FALSE(expected.empty()) << "no line has an EXPECT mark";
  for (const std::string& line : expected) EXPECT_EQ(line.substr(0, 4), GetParam().substr(0, 4));
  const CheckResult& result = checkMistake(GetParam());
  std::set<std::string> reported;
  for (const Diagnostic& d : result.diagnostics) {
    reported.insert(fmt::format("{} {}:{}", d.id, fs::path(d.file).filename().string(), d.line));
    const DiagnosticInfo* info = findDiagnostic(d.id);
    ASSERT_NE(info, nullptr) << d.id;
    EXPECT_EQ(d.severity, info->severity);
  }
  if (namesIn("known_misses.txt").contains(GetParam())) {
    EXPECT_NE(reported, expected) << "is reported now: remove it from known_misses.txt";
    return;
  }
  EXPECT_EQ(reported, expected) << textOf(result) << locationsOf(program, expected) << locationsOf(program, reported);
}

void expectMessages(const std::string& program) {
  const std::vector<std::string> messages = messagesOf(program, checkMistake(program).diagnostics);
  if (messages == expectedMessages(program)) return;
  for (const std::string& line : messages) ADD_FAILURE() << "\nmessages.txt: " << line;
  if (messages.empty()) ADD_FAILURE() << "no message, but messages.txt has one";
}

TEST_P(Mistakes, HaveTheirMessages) { expectMessages(GetParam()); }

// The programs whose messages contain numbers, for the short tests.
std::vector<std::string> programsWithNumbers() {
  static const std::regex kNumber("\t.*(^|[^A-Za-z0-9_.])[0-9]");
  std::istringstream lines(readTextFile(kCheck / "messages.txt"));
  std::set<std::string> names;
  for (std::string line; std::getline(lines, line);)
    if (std::regex_search(line, kNumber)) names.insert(line.substr(0, line.find('\t')));
  return {names.begin(), names.end()};
}

class NumbersInMessages : public testing::TestWithParam<std::string> {};

TEST_P(NumbersInMessages, AreThoseOfTheProgram) { expectMessages(GetParam()); }

INSTANTIATE_TEST_SUITE_P(Corpus, NumbersInMessages, testing::ValuesIn(programsWithNumbers()),
                         [](const auto& test) { return test.param; });

TEST_P(Mistakes, AreNotReportedAfterRepair) {
  const test::Case program = caseOf(kMistakes, GetParam());
  EXPECT_FALSE(program.fixed.empty()) << "the case has no repaired version";
  const Files files = program.allFixed();
  EXPECT_TRUE(expectedOf(files).empty()) << "the repaired version has an EXPECT mark";
  EXPECT_EQ(textOf(checkProgram(files)), "");
}

INSTANTIATE_TEST_SUITE_P(Corpus, Mistakes, testing::ValuesIn(namesOfCases(kMistakes)),
                         [](const auto& test) { return test.param; });

class Idioms : public testing::TestWithParam<std::string> {};

TEST_P(Idioms, AreNotReported) {
  const test::Case program = caseOf(kIdioms, GetParam());
  EXPECT_TRUE(program.fixed.empty()) << "an idiom has an EXPECT or FIX mark";
  const std::string reported = textOf(checkProgram(program.files));
  if (namesIn("known_false_alarms.txt").contains(GetParam())) {
    EXPECT_NE(reported, "") << "is not reported now: remove it from known_false_alarms.txt";
    return;
  }
  EXPECT_EQ(reported, "");
}

INSTANTIATE_TEST_SUITE_P(Corpus, Idioms, testing::ValuesIn(namesOfCases(kIdioms)),
                         [](const auto& test) { return test.param; });

// Only a run can report Q001 to Q007 (tests/gpu/program/instrument_test.cpp), and Q016 needs a file of a megabyte.
TEST(MistakesCorpus, HasAnEntryForEachId) {
  const std::vector<std::string> names = namesOfCases(kMistakes);
  for (const DiagnosticInfo& info : allDiagnostics()) {
    if (info.id < "Q010" || info.id == "Q016") continue;
    // Of pipelines that applications create: modules_test.cpp, tests/layer.
    if (info.rule.starts_with("check/modules/") || info.rule == "across_stages/hit_records") continue;
    EXPECT_TRUE(std::ranges::any_of(names, [&](const std::string& name) {
      return name.starts_with(std::string(info.id) + "_");
    })) << info.id;
  }
}

TEST(MistakesCorpus, ListsOfKnownErrorsNameExistingPrograms) {
  for (const auto& [list, folder] : {std::pair{"known_misses.txt", kMistakes}, {"known_false_alarms.txt", kIdioms}})
    for (const std::string& name : namesIn(list)) EXPECT_TRUE(fs::exists(folder / (name + ".case"))) << name;
}

}  // namespace
}  // namespace quintet::check
