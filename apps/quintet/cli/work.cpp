// SPDX-License-Identifier: Apache-2.0
#include "cli/work.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
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
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

Work* work = nullptr;
int results = -1;  // a file in memory; negative if there is none

template <std::size_t N>
void assign(std::array<char, N>& target, std::string_view text) {
  const std::size_t length = std::min(text.size(), N - 1);
  target[length] = '\0';
  std::memcpy(target.data(), text.data(), length);
}

}  // namespace

bool shareWork() {
  void* memory = ::mmap(nullptr, sizeof(Work), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return false;
  work = new (memory) Work;
  results = ::memfd_create("quintet results", MFD_CLOEXEC);
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

// In the lines of results: "+SCENE NAME" begins a scene, "=SCENE" and "!SCENE" end it.
void sceneBegins(std::size_t scene, std::string_view name) {
  std::string line = "+" + std::to_string(scene) + " " + std::string(name);
  std::ranges::replace(line, '\n', ' ');
  addWorkResult(line + "\n");
}

void sceneEnds(std::size_t scene, bool failed) { addWorkResult((failed ? "!" : "=") + std::to_string(scene) + "\n"); }

void scenesEnd() { clearWorkResults(); }

SceneProgress sceneProgress() {
  SceneProgress progress;
  for (const std::string& line : workResults()) {
    const std::size_t scene = std::strtoull(line.c_str() + 1, nullptr, 10);
    if (line[0] == '+') {
      if (progress.unfinished) progress.failed.push_back(progress.next - 1);
      progress.next = scene + 1;
      progress.unfinished = true;
      progress.name = line.substr(std::min(line.find(' ') + 1, line.size()));
    } else {
      if (line[0] == '!') progress.failed.push_back(scene);
      progress.unfinished = false;
    }
  }
  if (progress.unfinished) progress.failed.push_back(progress.next - 1);
  return progress;
}

void setWorkFile(const std::filesystem::path& file) {
  if (work) assign(work->file, file.native());
}

std::string_view workStage() { return work ? work->stage.data() : ""; }
std::string_view workProgram() { return work ? work->program.data() : ""; }
std::string_view workFile() { return work ? work->file.data() : ""; }

}  // namespace quintet::cli
