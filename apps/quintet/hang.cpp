#include "hang.h"

#include <unistd.h>

#include <cstdio>

#include <fmt/format.h>

#include "base/file.h"
#include "diagnostics_view.h"
#include "gpu/error.h"
#include "standard_error.h"
#include "values.h"

namespace quintet::app {

void withoutHanging(const program::Program& program, bool json, const std::function<void()>& launches) {
  try {
    launches();
  } catch (const gpu::TimeoutError& error) {
    const std::string text = fmt::format(
        "the launch did not end within {:g} s: does a shader loop for ever? (--timeout SECONDS lets it run longer)",
        error.seconds());
    if (json) {
      try {
        writeFile(
            "-", diagnosticsJson({{shader::Severity::error, program.path(program.rayGeneration), 0, 0, "HANG", text}}));
      } catch (const Error&) {  // nobody reads
      }
    }
    const char* newLine = ::isatty(STDERR_FILENO) == 1 ? "\r\x1b[K" : "";  // over the progress bar
    printError("{}quintet: {}: {}\n", newLine, plain(program.name), text);
    std::fflush(nullptr);
    ::_exit(1);
  }
}

}  // namespace quintet::app
