// SPDX-License-Identifier: Apache-2.0
// A program.toml is untrusted text: parseProgram returns a usable Program or throws one FileError with a line of the text.
// Deterministic mutations of the built-in programs and of a text with every key.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/error.h"
#include "program/description/generated_glsl.h"
#include "program/description/parser.h"
#include "program/help.h"
#include "program/hit_group_binding.h"
#include "program/load.h"
#include "program/program_test_support.h"

namespace quintet::program {
namespace {

const std::string kEveryKey = R"([program]
description = "every key"
ray_generation = "main.rgen"
max_recursion = 3
samples_per_launch = 16
accumulation = "program"
keeps_instance_order = true
callables = ["noise.rcall"]
record = { weight = 5 }
[[ray]]
name = "radiance"
miss = "sky.rmiss"
record = { tint = [0, 0, 1] }
[[ray]]
name = "shadow"
miss = "<quintet/stages/shadow.rmiss>"
[[miss]]
name = "other"
file = "sky.rmiss"
[[callable]]
name = "wood"
file = "noise.rcall"
[[hit_group]]
name = "a"
geometry = ["csg", "custom"]
material = "glass"
primitives = ["balls", "more"]
record = { tint = [1, 0, 0], weight = 2.5 }
radiance = { closest_hit = "hit.rchit", any_hit = "alpha.rahit", intersection = "box.rint", record = { tint = [0, 1, 0] } }
[[output]]
name = "color"
kind = "normal"
help = "x"
[[record]]
name = "tint"
type = "color"
default = [1, 1, 1]
[[record]]
name = "weight"
type = "float"
default = 1e3
[[parameter]]
name = "mode"
type = "choice"
choices = ["plain", "heat"]
default = "heat"
[[parameter]]
name = "wood"
type = "image"
default = ""
encoding = "linear"
[[parameter]]
name = "count"
type = "uint"
default = 3
min = 0
max = 10
unit = "m"
)";

// Pieces to insert: tokens of TOML and of program.toml, and bytes that break readers.
// clang-format off
const std::vector<std::string> kPieces = {
    "[", "]", "[[", "]]", "{", "}", "=", ",", ".", "\"", "'", "\"\"\"", "#", "\n", "\r", "\t", " ", "\\", "\\u0000", "\\uD800",
    std::string(1, '\0'), "\x7f", "\xff", "\xef\xbb\xbf", "ä", "0", "-1", "1e400", "nan", "-inf", "0x", "9223372036854775808",
    "1979-05-27T07:32:00Z", "true", "false", "[]", "{}", "[[ray]]", "[program]", "[[hit_group]]", "[[record]]", "[[parameter]]",
    "[[miss]]", "[[output]]\n", "name = \"a\"\n", "record = ", "radiance = ", "a.b.c = 1\n", "<>", "../../etc/passwd",
    "<quintet/stages/surface.rchit>", "{ x = { y = [ { z = 1 } ] } }", "[[[[[[[[[[[[", "gl_", "__"};
// clang-format on

class Mutator {
 public:
  explicit Mutator(std::vector<std::string> texts) : texts_(std::move(texts)) {}

  std::string next() {
    std::string text = texts_[pick(texts_.size())];
    for (std::size_t i = 0, count = 1 + pick(4); i < count; ++i) mutate(text);
    return text;
  }

 private:
  std::size_t pick(std::size_t count) { return random_() % count; }

  void mutate(std::string& text) {
    const std::size_t at = pick(text.size() + 1), length = std::min(text.size() - at, pick(40));
    switch (pick(7)) {
      case 0: text.insert(at, kPieces[pick(kPieces.size())]); break;
      case 1: text.replace(at, length, kPieces[pick(kPieces.size())]); break;
      case 2: text.erase(at, length); break;
      case 3: text.insert(pick(text.size() + 1), text.substr(at, length)); break;
      case 4: text.resize(at); break;
      case 5: {
        const std::string& other = texts_[pick(texts_.size())];
        text.replace(at, length, other.substr(pick(other.size()), pick(80)));
        break;
      }
      default:
        if (at < text.size()) text[at] = static_cast<char>(static_cast<unsigned char>(text[at]) ^ (1u << pick(8)));
    }
  }

  std::mt19937 random_{20240607};
  std::vector<std::string> texts_;
};

// Uses a program as its callers do.
void use(const Program& program) {
  EXPECT_FALSE(program.rays.empty());
  EXPECT_FALSE(program.outputs.empty());
  EXPECT_EQ(generatedFiles(program).size(), 2u);
  EXPECT_FALSE(describeAsJson(program).empty());
  ParameterValues values(program.parameters);
  const std::string before = values.describe();
  EXPECT_GE(values.pack().size(), 4u);
  values.setFromJson(values.toJson(), "values.json");
  EXPECT_EQ(values.describe(), before);
  if (!program.hitGroups.empty()) {
    EXPECT_LT(hitGroupFor(program, {GeometryKind::csg, true, "balls", "glass"}), program.hitGroups.size());
  }
  for (const HitGroup& group : program.hitGroups)
    for (const auto& [ray, shaders] : group.shaders)
      EXPECT_TRUE(shaders.record.empty() || shaders.record.size() == program.record.size());
}

TEST(ProgramFuzz, ReadsAProgramOrReportsOneError) {
  std::vector<std::string> texts = {kEveryKey, kSmall};
  Files files = someFiles();
  for (const std::string& name : builtInPrograms()) {
    const Program program = loadProgram(name);
    if (program.files.contains("program.toml")) texts.push_back(program.files.at("program.toml"));
    files.insert(program.files.begin(), program.files.end());
  }
  Mutator mutator(texts);
  std::size_t good = 0, bad = 0;
  for (int i = 0; i < 40000; ++i) {
    const std::string text = mutator.next();
    const auto lines = 1 + std::count(text.begin(), text.end(), '\n');
    try {
      use(parse(text, files));
      ++good;
    } catch (const FileError& error) {
      ++bad;
      EXPECT_EQ(error.file(), "folder/demo/program.toml") << text;
      ASSERT_EQ(error.location().substr(0, 5), "line ") << error.what() << "\n" << text;
      const int line = std::stoi(error.location().substr(5));
      EXPECT_GE(line, 1) << error.what() << "\n" << text;
      EXPECT_LE(line, lines) << error.what() << "\n" << text;
      EXPECT_FALSE(error.problem().empty());
    } catch (const std::exception& error) {
      FAIL() << error.what() << "\n" << text;
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(good, 1000u) << "the mutations leave too few valid programs";
  EXPECT_GT(bad, 1000u);
}

TEST(ProgramFuzz, RejectsDeepNesting) {
  const auto keys = [](std::size_t depth) {
    std::string key = "a";
    for (std::size_t i = 0; i < depth; ++i) key += ".a";
    return key;
  };
  EXPECT_THROW(parse(kSmall + keys(1u << 20) + " = 1\n"), FileError);
  EXPECT_THROW(parse(kSmall + ("[" + keys(1u << 20)) + "]\n"), FileError);
  EXPECT_THAT(errorOf(kSmall + keys(17) + " = 1\n"), isErrorAt(8, {"16"}));
  EXPECT_THROW(parse(kSmall + ("x = " + std::string(1u << 20, '['))), FileError);
  std::string tables = "x = ";
  for (int i = 0; i < (1 << 18); ++i) tables += "{a=";
  EXPECT_THROW(parse(kSmall + tables), FileError);
}

TEST(ProgramFuzz, ReadsValuesOrReportsOneError) {
  const Program program = parse(kEveryKey);
  Mutator mutator({R"({"mode": "plain", "wood": "a/b.png", "count": 7})", R"({"count": 7.0, "mode": "heat"})",
                   R"({"wood": ""})", R"({"count": [1, 2, 3], "mode": null, "wood": {"a": true}})"});
  for (int i = 0; i < 20000; ++i) {
    const std::string text = mutator.next();
    ParameterValues values(program.parameters);
    const std::string before = values.describe();
    try {
      values.setFromJson(text, "values.json");
    } catch (const FileError& error) {
      EXPECT_EQ(error.file(), "values.json");
      EXPECT_EQ(values.describe(), before);
    } catch (const std::exception& error) {
      FAIL() << error.what() << "\n" << text;
    }
  }
}

}  // namespace
}  // namespace quintet::program
