// SPDX-License-Identifier: Apache-2.0
// Reads the cases of the check's corpus (tests/check): one file per program, with its repaired version.
// tests/check/README.md describes the format.
#ifndef QUINTET_TESTS_UNIT_CHECK_CASE_FILE_H
#define QUINTET_TESTS_UNIT_CHECK_CASE_FILE_H

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace quintet::test {

using CaseFiles = std::map<std::string, std::string>;  // name → text

struct Case {
  std::string name;            // of the case file, without ".case"
  CaseFiles files;             // of the program, including its default files
  CaseFiles fixed;             // the files that differ in the repaired version, or that only it has
  CaseFiles allFixed() const;  // all files of the repaired version

  // For each section, the lines of the case file that contain the lines of `files`.
  std::map<std::string, std::vector<int>> lines;
  // "main.rgen:12" → "NAME.case:31"; empty for a default file or a line that the section does not have.
  std::string locationOf(const std::string& file, int line) const;
};

// Throws Error with the name and the line of a case file that is malformed. `defaults`: the files that a case can omit.
Case parseCase(std::string_view text, const std::string& name, const CaseFiles& defaults = {});

// Reads a case. The files that it can omit are in the folder `default` beside the folder of the case.
Case readCase(const std::filesystem::path& file);

// The case files directly inside a folder, sorted.
std::vector<std::filesystem::path> casesIn(const std::filesystem::path& folder);

// Creates a folder with the files of a case, and its folder `repaired` with the files that differ there, if any do.
void writeCase(const Case&, const std::filesystem::path& folder);

}  // namespace quintet::test
#endif
