// SPDX-License-Identifier: Apache-2.0
// A program on disk that tests edit, and an observer that records its checks.
#ifndef QUINTET_TESTS_UNIT_JOB_PROGRAM_FOLDER_H
#define QUINTET_TESTS_UNIT_JOB_PROGRAM_FOLDER_H

#include <filesystem>
#include <string>
#include <vector>

#include "base/file.h"
#include "check/check_test_support.h"
#include "job/program_checks.h"
#include "temp_folder.h"

namespace quintet::job {

// Writes check::cleanFiles().
inline void writeProgram(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const auto& [name, text] : check::cleanFiles()) writeFile(folder / name, text);
}

// Replaces `from` in a file by `to`.
inline void edit(const std::filesystem::path& file, const std::string& from, const std::string& to) {
  writeFile(file, program::changed(readTextFile(file), from, to));
}

// The limits that hold on every device, so that no device is required.
inline CheckRequest requestFor(std::vector<std::string> programs) {
  CheckRequest request;
  request.programs = std::move(programs);
  request.device = "none";
  return request;
}

// "ID file" of each diagnostic, with the file's name only.
inline std::vector<std::string> idsOf(const CheckReport& report) {
  std::vector<std::string> ids;
  for (const Diagnostic& d : report.diagnostics())
    ids.push_back(d.id + " " + std::filesystem::path(d.file).filename().string());
  return ids;
}

struct CheckRecorder : CheckObserver {
  void started(const std::string& name) override { events.push_back("started " + name); }
  void finished(const CheckReport& report) override { events.push_back("finished " + report.programs.back().name); }
  std::vector<std::string> events;
};

}  // namespace quintet::job
#endif
