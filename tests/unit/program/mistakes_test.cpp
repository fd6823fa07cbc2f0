// The corpus of mistakes (tests/check/mistakes): each program has exactly one mistake, which is reported at the line
// that says so, and its repaired twin is silent. The device of these tests has every defect of docs/design/quirks.md.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "base/toml.h"
#include "check_test_support.h"
#include "program/diagnostic_catalog.h"
#include "program/lecture.h"

namespace quintet::program {
namespace {

namespace fs = std::filesystem;

const fs::path kCorpus = fs::path(QUINTET_SOURCE_ROOT) / "tests/check/mistakes";

std::string textOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::string> mistakes() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(kCorpus))
    if (entry.is_directory()) names.push_back(entry.path().filename());
  std::ranges::sort(names);
  return names;
}

void readFolder(const fs::path& folder, Files& files) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) files[entry.path().filename()] = textOf(entry.path());
}

// facts.toml: [[geometry]] kind, alpha, name, material; [[instance]] name, first, count, mask, force_opaque.
std::optional<SceneFacts> factsOf(const Files& files) {
  const auto found = files.find("facts.toml");
  if (found == files.end()) return {};
  const toml::table table = toml::parse(found->second);
  SceneFacts facts{"scene.toml", {}, {}};
  constexpr std::string_view kKinds[] = {"triangles", "solids", "csg", "custom"};
  for (const auto& node : *table["geometry"].as_array()) {
    const toml::table& g = *node.as_table();
    const std::string kind = g["kind"].value_or("");
    const auto at = std::ranges::find(kKinds, kind);
    EXPECT_NE(at, std::end(kKinds)) << kind;
    facts.geometries.push_back({static_cast<GeometryKind>(at - std::begin(kKinds)), g["alpha"].value_or(false),
                                g["name"].value_or(std::string()), g["material"].value_or(std::string())});
  }
  for (const auto& node : *table["instance"].as_array()) {
    const toml::table& i = *node.as_table();
    facts.instances.push_back({i["name"].value_or(std::string()), i["first"].value_or(0u), i["count"].value_or(1u),
                               i["mask"].value_or(0xFFu), i["force_opaque"].value_or(false), false});
  }
  return facts;
}

// "Q101 main.rgen:12" for each mark: "EXPECT Q101" of its own line, "EXPECT+1 Q101" of the next.
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

CheckResult checkMistake(const Files& files) {
  DeviceLimits limits;
  limits.quirks.changesNestedBuiltIns = limits.quirks.corruptsHitAttributes = true;
  limits.quirks.sharesAnyHit = limits.quirks.sharesLocalArrays = true;
  const std::optional<SceneFacts> facts = factsOf(files);
  const auto lecture = files.find("program.rt.glsl");
  if (lecture == files.end()) return checkFiles(files, facts ? &*facts : nullptr, limits);
  return check(parseLecture(lecture->second, lecture->first, "folder/demo"), checkCompiler(), facts ? &*facts : nullptr,
               limits);
}

class Mistakes : public testing::TestWithParam<std::string> {};

TEST_P(Mistakes, ExactlyThisOneIsReported) {
  Files files;
  readFolder(kCorpus / GetParam(), files);
  const std::set<std::string> expected = expectedOf(files);
  ASSERT_FALSE(expected.empty()) << "no line is marked EXPECT";
  for (const std::string& line : expected) EXPECT_EQ(line.substr(0, 4), GetParam().substr(0, 4));
  const CheckResult result = checkMistake(files);
  std::set<std::string> reported;
  for (const shader::Diagnostic& d : result.diagnostics) {
    reported.insert(fmt::format("{} {}:{}", d.id, fs::path(d.file).filename().string(), d.line));
    const DiagnosticInfo* info = findDiagnostic(d.id);
    ASSERT_NE(info, nullptr) << d.id;
    EXPECT_EQ(d.severity, info->severity);
  }
  EXPECT_EQ(reported, expected) << program::textOf(result);
}

TEST_P(Mistakes, RepairedTwinIsSilent) {
  Files files;
  readFolder(kCorpus / GetParam(), files);
  readFolder(kCorpus / GetParam() / "repaired", files);
  EXPECT_TRUE(expectedOf(files).empty()) << "a mark is left in the repaired twin";
  EXPECT_EQ(program::textOf(checkMistake(files)), "");
}

INSTANTIATE_TEST_SUITE_P(Corpus, Mistakes, testing::ValuesIn(mistakes()), [](const auto& test) { return test.param; });

// Q001 to Q006 only a run can report (tests/gpu/program/instrument_test.cpp); Q016 is about a file of a megabyte.
TEST(MistakesCorpus, EveryIdHasAnEntry) {
  const std::vector<std::string> names = mistakes();
  for (const DiagnosticInfo& info : allDiagnostics()) {
    if (info.id < "Q010" || info.id == "Q016") continue;
    EXPECT_TRUE(std::ranges::any_of(names, [&](const std::string& name) {
      return name.starts_with(std::string(info.id) + "_");
    })) << info.id;
  }
}

}  // namespace
}  // namespace quintet::program
