// SPDX-License-Identifier: Apache-2.0
// A small valid program.toml, and functions that change it and check errors.
#ifndef QUINTET_TESTS_UNIT_PROGRAM_SUPPORT_H
#define QUINTET_TESTS_UNIT_PROGRAM_SUPPORT_H

#include <gmock/gmock.h>

#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "program/description/parser.h"
#include "program/description/program.h"
#include "shader/compiler.h"

namespace quintet::program {

using Files = std::map<std::string, std::string>;

inline Files someFiles() {
  return {{"main.rgen", ""},   {"sky.rmiss", ""}, {"dark.rmiss", ""}, {"hit.rchit", ""},
          {"alpha.rahit", ""}, {"box.rint", ""},  {"noise.rcall", ""}};
}

// A program.toml of 7 lines; tests append tables from line 8 on.
inline const std::string kSmall = R"([program]
ray_generation = "main.rgen"
description = "a test"

[[ray]]
name = "radiance"
miss = "sky.rmiss"
)";

inline Program parse(const std::string& toml, const Files& files = someFiles()) {
  return parseProgram(toml, "demo", "folder/demo", files);
}

inline const shader::Compiler& compiler() {
  static const shader::Compiler kCompiler{shader::CompilerOptions{}};
  return kCompiler;
}

// A program.toml with two outputs and a parameter of most types; parse it with parameterFiles().
inline const std::string kParameters = kSmall + R"(
[[output]]
name = "color"
[[output]]
name = "where"
kind = "normal"
help = "the normal"
[[parameter]]
name = "on"
type = "bool"
default = true
[[parameter]]
name = "bounces"
type = "int"
default = 12
min = 0
max = 64
help = "how often"
[[parameter]]
name = "count"
type = "uint"
default = 3
[[parameter]]
name = "far"
type = "float"
default = 0.1
min = 0
unit = "m"
[[parameter]]
name = "tint"
type = "color"
default = [1, 0.5, 0.25]
max = 1
[[parameter]]
name = "mode"
type = "choice"
choices = ["plain", "heat"]
default = "heat"
[[parameter]]
name = "wood"
type = "image"
default = "wood.png"
encoding = "linear"
[[parameter]]
name = "map"
type = "image"
default = ""
)";

inline Files parameterFiles() {
  Files all = someFiles();
  all["wood.png"] = "";
  return all;
}

// Returns the error of a program.toml as "line 3: problem"; empty if it has none.
inline std::string errorOf(const std::string& toml, const Files& files = someFiles()) {
  try {
    parse(toml, files);
  } catch (const FileError& error) {
    EXPECT_EQ(error.file(), "folder/demo/program.toml");
    return error.location() + ": " + error.problem();
  }
  return {};
}

// Matches an error of errorOf() in this line whose message contains all words.
inline auto isErrorAt(int line, const std::vector<std::string>& words) {
  std::vector<testing::Matcher<std::string>> all{testing::StartsWith("line " + std::to_string(line) + ": ")};
  for (const std::string& word : words) all.push_back(testing::HasSubstr(word));
  return testing::AllOfArray(all);
}

// Returns the text with the first `from` replaced.
inline std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

}  // namespace quintet::program
#endif
