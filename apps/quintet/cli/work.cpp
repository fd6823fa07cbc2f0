// SPDX-License-Identifier: Apache-2.0
#include "cli/work.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <string>
#include <vector>

namespace quintet::cli {
namespace {

struct Work {
  std::array<char, 128> stage{};
  std::array<char, 256> program{};
  std::array<char, 4096> file{};
  std::array<char, 1 << 16> watched{};        // 'd' for a folder or 'f' for a file, path, '\0'; ends with '\0'
  std::atomic<std::uint64_t> resultBytes{0};  // of complete lines in the file of results
  std::array<char, 4096> scene{};             // the one that was started last
  std::atomic<std::uint64_t> sceneCount{0};   // scenes that were started
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

Work* work = nullptr;
// Files in memory; negative if there is none.
int results = -1;
int sceneStates = -1;  // a SceneState for each scene that was started

enum class SceneState : unsigned char { started, ended, failed };
static_assert(sizeof(SceneState) == 1);

template <std::size_t N>
void assign(std::array<char, N>& target, std::string_view text) {
  const std::size_t length = std::min(text.size(), N - 1);
  target[length] = '\0';
  std::memcpy(target.data(), text.data(), length);
}

void setSceneState(std::size_t scene, SceneState state) {
  if (!work || sceneStates < 0 || ::pwrite(sceneStates, &state, sizeof state, static_cast<off_t>(scene)) != 1) return;
  work->sceneCount = scene + 1;
}

}  // namespace

bool shareWork() {
  void* memory = ::mmap(nullptr, sizeof(Work), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return false;
  work = new (memory) Work;
  results = ::memfd_create("quintet results", MFD_CLOEXEC);
  sceneStates = ::memfd_create("quintet scenes", MFD_CLOEXEC);
  return true;
}

void setWorkStage(std::string_view stage) {
  if (work) assign(work->stage, stage);
}

void setWorkProgram(std::string_view program) {
  if (work) assign(work->program, program);
}

void setWatchedFiles(const job::WatchList& list) {
  if (!work) return;
  std::string entries;
  const auto add = [&](char kind, const std::filesystem::path& path) {
    const std::string entry = kind + path.string() + '\0';
    if (entries.size() + entry.size() < work->watched.size()) entries += entry;
  };
  for (const std::filesystem::path& folder : list.folders) add('d', folder);
  for (const std::filesystem::path& file : list.files) add('f', file);
  std::memcpy(work->watched.data(), entries.c_str(), entries.size() + 1);
}

job::WatchList watchedFiles() {
  job::WatchList list;
  if (!work) return list;
  for (const char* entry = work->watched.data(); *entry; entry += std::strlen(entry) + 1)
    (*entry == 'd' ? list.folders : list.files).emplace_back(entry + 1);
  return list;
}

void addWorkResult(const std::string& line) {
  if (!work || results < 0) return;
  const std::uint64_t begin = work->resultBytes;
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t written = ::pwrite(results, line.data() + done, line.size() - done, static_cast<off_t>(begin + done));
    if (written <= 0) return;
    done += static_cast<std::size_t>(written);
  }
  work->resultBytes = begin + line.size();
}

void clearWorkResults() {
  if (work) work->resultBytes = 0;
}

std::vector<std::string> workResults() {
  std::vector<std::string> lines;
  if (!work || results < 0) return lines;
  std::string text(work->resultBytes, '\0');
  const ssize_t read = ::pread(results, text.data(), text.size(), 0);
  text.resize(read > 0 ? static_cast<std::size_t>(read) : 0);
  for (std::size_t at = 0, end; (end = text.find('\n', at)) != text.npos; at = end + 1)
    lines.push_back(text.substr(at, end - at));
  return lines;
}

void sceneBegins(std::size_t scene, std::string_view name) {
  if (work) assign(work->scene, name);
  setSceneState(scene, SceneState::started);
}

void sceneEnds(std::size_t scene, bool failed) {
  setSceneState(scene, failed ? SceneState::failed : SceneState::ended);
}

void scenesEnd() {
  if (work) work->sceneCount = 0;
}

SceneProgress sceneProgress() {
  SceneProgress progress;
  if (!work || sceneStates < 0) return progress;
  std::vector<SceneState> states(work->sceneCount);
  const ssize_t read = ::pread(sceneStates, states.data(), states.size(), 0);
  states.resize(read > 0 ? static_cast<std::size_t>(read) : 0);
  for (std::size_t scene = 0; scene < states.size(); ++scene)
    if (states[scene] != SceneState::ended) progress.failed.push_back(scene);
  progress.next = states.size();
  progress.unfinished = !states.empty() && states.back() == SceneState::started;
  progress.name = work->scene.data();
  return progress;
}

void setWorkFile(const std::filesystem::path& file) {
  if (work) assign(work->file, file.native());
}

std::string_view workStage() { return work ? work->stage.data() : ""; }
std::string_view workProgram() { return work ? work->program.data() : ""; }
std::string_view workFile() { return work ? work->file.data() : ""; }

}  // namespace quintet::cli
