// SPDX-License-Identifier: Apache-2.0
// Runs the quintet binary as a separate process and returns its output.
#ifndef QUINTET_TESTS_CLI_PROCESS_H
#define QUINTET_TESTS_CLI_PROCESS_H

#include <sys/types.h>

#include <chrono>
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

// A process whose standard error is read while it runs.
class LiveRun {
 public:
  LiveRun(const LiveRun&) = delete;
  LiveRun& operator=(const LiveRun&) = delete;

  // Reads until `text` appears. False: the process ended before, wrote nothing for two minutes, or the limit is over.
  bool waitFor(const std::string& text);
  // The same, in the output after the last match of this function.
  bool waitForNext(const std::string& text);
  void signal(int number);
  pid_t id() const { return process_; }
  void kill();         // and waits for the process alone, as a shell does: processes that it started may still run
  RunResult finish();  // waits for the end as waitFor() does, else kills the process; `err` is all that was read

 protected:
  using Clock = std::chrono::steady_clock;
  LiveRun() = default;
  ~LiveRun();  // kills the process if it still runs

  pid_t process_ = -1;
  int output_ = -1;
  Clock::time_point deadline_ = Clock::time_point::max();

 private:
  bool readSome();  // false: the output is closed, or the time is over
  bool closed_ = false;
  std::string text_;
  std::size_t seen_ = 0;  // end of the last match of waitForNext
};

// Its standard error is a terminal. TERM is "xterm", unless `environment` has another value.
class TerminalRun : public LiveRun {
 public:
  using Environment = std::vector<std::pair<std::string, std::string>>;
  TerminalRun(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
              unsigned short columns = 100, const Environment& environment = {});
};

// Its standard error is a pipe, and nothing is a terminal. Standard output goes to a file, or nowhere. `limit`: for all
// waits together.
class PipeRun : public LiveRun {
 public:
  PipeRun(const std::vector<std::string>& arguments, const RunOptions& options,
          std::chrono::seconds limit = std::chrono::seconds(60));
};

}  // namespace quintet::test
#endif
