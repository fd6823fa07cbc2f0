// A small valid program.toml and short ways to change it and to read an error.
#ifndef QUINTET_TESTS_UNIT_PROGRAM_SUPPORT_H
#define QUINTET_TESTS_UNIT_PROGRAM_SUPPORT_H

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "base/error.h"
#include "program/program.h"

namespace quintet::program {

using Files = std::map<std::string, std::string>;

inline Files someFiles() {
  return {{"main.rgen", ""},   {"sky.rmiss", ""}, {"dark.rmiss", ""}, {"hit.rchit", ""},
          {"alpha.rahit", ""}, {"box.rint", ""},  {"noise.rcall", ""}};
}

// Lines 1 to 3 and 5 to 7; more can be appended from line 8 on.
inline const char* kSmall = R"([program]
ray_generation = "main.rgen"
description = "a test"

[[ray]]
name = "radiance"
miss = "sky.rmiss"
)";

inline Program parse(const std::string& toml, const Files& files = someFiles()) {
  return parseProgram(toml, "demo", "folder/demo", files);
}

// "line 3: what is wrong"; an empty text if nothing is.
inline std::string errorOf(const std::string& toml, const Files& files = someFiles()) {
  try {
    parse(toml, files);
  } catch (const FileError& error) {
    EXPECT_EQ(error.file(), "folder/demo/program.toml");
    return error.place() + ": " + error.problem();
  }
  return {};
}

// The text with the first `from` replaced.
inline std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

}  // namespace quintet::program
#endif
