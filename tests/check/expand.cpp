// SPDX-License-Identifier: Apache-2.0
// Writes cases of the corpus as folders, for programs that read files (README.md).
//
//   quintet_expand_cases FOLDER CASE…
//
// Each case becomes FOLDER/NAME with the program, and FOLDER/NAME/repaired with the files that differ in the repaired version.
// The exit status is 1 if a case is malformed or a file cannot be read or written, and 2 for a wrong command line.
#include <cstdio>
#include <filesystem>

#include "base/error.h"
#include "check/case_file.h"

int main(int count, char** arguments) {
  if (count < 3) {
    std::fputs("usage: quintet_expand_cases FOLDER CASE…\n", stderr);
    return 2;
  }
  try {
    for (int i = 2; i < count; ++i) {
      const quintet::test::Case program = quintet::test::readCase(arguments[i]);
      writeCase(program, std::filesystem::path(arguments[1]) / program.name);
    }
  } catch (const quintet::Error& error) {
    std::fprintf(stderr, "quintet_expand_cases: %s\n", error.what());
    return 1;
  }
}
