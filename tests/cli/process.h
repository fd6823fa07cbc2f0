// Runs the quintet binary as a process of its own and keeps what it says.
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
  std::filesystem::path folder;                                  // to run in
  std::vector<std::pair<std::string, std::string>> environment;  // added
  std::filesystem::path out;  // standard output goes to this file instead of RunResult
  std::string shell;          // a line of sh before the binary takes over: "exec >&-", "ulimit -f 0"
};

RunResult run(const std::vector<std::string>& arguments, const RunOptions& options = {});

// A process whose standard error is a terminal of 100 columns.
class TerminalRun {
 public:
  TerminalRun(const std::vector<std::string>& arguments, const std::filesystem::path& folder);
  ~TerminalRun();  // ends the process if it still runs
  TerminalRun(const TerminalRun&) = delete;
  TerminalRun& operator=(const TerminalRun&) = delete;

  // Reads until `text` has been written; false if the process ended before.
  bool waitFor(const std::string& text);
  // The same, but only in what comes after the last match of this function.
  bool waitForNext(const std::string& text);
  void signal(int number);
  RunResult finish();  // waits for the end; `err` holds everything written to the terminal

 private:
  bool readSome();  // false: the other side is closed
  pid_t process_ = -1;
  int terminal_ = -1;
  std::string text_;
  std::size_t seen_ = 0;  // end of the last match of waitForNext
};

}  // namespace quintet::test
#endif
