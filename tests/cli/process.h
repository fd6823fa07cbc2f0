// SPDX-License-Identifier: Apache-2.0
// Runs the quintet binary as a separate process and returns its output.
#ifndef QUINTET_TESTS_CLI_PROCESS_H
#define QUINTET_TESTS_CLI_PROCESS_H

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace quintet::test {

struct RunResult {
  int status = -1;  // exit status; 1000 + signal if a signal ended it
  std::string out;
  std::string err;
};

struct RunOptions {
  std::filesystem::path folder;                                  // working directory
  std::vector<std::pair<std::string, std::string>> environment;  // additional variables
  std::filesystem::path out;                                     // file for standard output, instead of RunResult::out
  std::string shell;  // shell command that runs before the binary: "exec >&-", "ulimit -f 0"
};

RunResult run(const std::vector<std::string>& arguments, const RunOptions& options = {});

// A process whose standard error is a terminal.
class TerminalRun {
 public:
  TerminalRun(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
              unsigned short columns = 100);
  ~TerminalRun();  // kills the process if it still runs
  TerminalRun(const TerminalRun&) = delete;
  TerminalRun& operator=(const TerminalRun&) = delete;

  // Reads until `text` appears. False: the process ended before, or wrote nothing for two minutes.
  bool waitFor(const std::string& text);
  // The same, in the output after the last match of this function.
  bool waitForNext(const std::string& text);
  void signal(int number);
  RunResult finish();  // waits for the end; `err` is the output to the terminal

 private:
  bool readSome(int timeoutMilliseconds);  // -1: no timeout. False: the terminal is closed, or the time is over
  pid_t process_ = -1;
  int terminal_ = -1;
  std::string text_;
  std::size_t seen_ = 0;  // end of the last match of waitForNext
};

}  // namespace quintet::test
#endif
