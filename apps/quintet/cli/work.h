// SPDX-License-Identifier: Apache-2.0
// What a command works on, in memory that it shares with its parent process: the message about a crash states it, and
// the parent continues to watch its files (cli/supervisor.h).
#ifndef QUINTET_CLI_WORK_H
#define QUINTET_CLI_WORK_H

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "job/source_watcher.h"

namespace quintet::cli {

// Before the child is created. Returns false if there is no memory.
bool shareWork();

// In the child; longer texts are truncated. Without shareWork() these have no effect.
void setWorkStage(std::string_view stage);            // "compiling shaders"
void setWorkProgram(std::string_view program);        // name
void setWorkFile(const std::filesystem::path& file);  // that is being written; empty for none
void setWatchedFiles(const job::WatchList& list);     // as far as 64 KiB suffice, folders first

// Results of the command so far that its --json prints at the end, in one line each. They are complete or missing.
void addWorkResult(const std::string& line);
void clearWorkResults();  // they are printed, or the command starts over

// In the child of a command that works on several scenes, which begin in their order. If one of them ends the process, a new
// process continues with the next one.
void sceneBegins(std::size_t scene, std::string_view name);
void sceneEnds(std::size_t scene, bool failed);
void scenesEnd();  // the command ends: no new process continues, even if the last scene has ended a process

struct SceneProgress {
  std::vector<std::size_t> failed;  // with the one that has not ended
  std::size_t next = 0;             // the scene after the one that was started last
  bool unfinished = false;          // a scene was started and has not ended
  std::string name;                 // of the scene that was started last
};
SceneProgress sceneProgress();  // in the parent, and in a new child

// In the parent, after the child has ended. Empty if unknown.
std::string_view workStage();
std::string_view workProgram();
std::string_view workFile();
job::WatchList watchedFiles();
std::vector<std::string> workResults();

}  // namespace quintet::cli
#endif
