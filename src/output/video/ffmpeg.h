// SPDX-License-Identifier: Apache-2.0
// The program ffmpeg as a child process that encodes raw frames from its standard input.
#ifndef QUINTET_OUTPUT_VIDEO_FFMPEG_H
#define QUINTET_OUTPUT_VIDEO_FFMPEG_H

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace quintet::output {

// Path of an executable in the folders of $PATH; empty if it is not found.
std::filesystem::path findProgram(const std::string& name);

// A running ffmpeg. It has a process group of its own, so that Ctrl-C on the terminal does not end it.
class FfmpegProcess {
 public:
  // Throws Error if the process cannot be started.
  FfmpegProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments);
  ~FfmpegProcess();  // kills the process if it is still running
  FfmpegProcess(const FfmpegProcess&) = delete;
  FfmpegProcess& operator=(const FfmpegProcess&) = delete;

  // Writes to the standard input of the process. Returns false if the process has ended; finish() then says why.
  bool write(std::span<const std::byte> bytes);
  // Closes the standard input and waits. Returns an empty text if the process succeeded, else what went wrong: the last
  // line that it printed.
  std::string finish();

 private:
  std::string lastMessage() const;
  void closeInput();

  int input_ = -1;     // our end of a socket pair
  int messages_ = -1;  // temporary file with the standard error of the process
  int pid_ = -1;
};

}  // namespace quintet::output
#endif
