// SPDX-License-Identifier: Apache-2.0
#include "cli/work.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <new>

namespace quintet::cli {
namespace {

struct Work {
  std::array<char, 128> stage{};
  std::array<char, 256> program{};
  std::array<char, 4096> file{};
};

Work* work = nullptr;

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
  return true;
}

void setWorkStage(std::string_view stage) {
  if (work) assign(work->stage, stage);
}

void setWorkProgram(std::string_view program) {
  if (work) assign(work->program, program);
}

void setWorkFile(const std::filesystem::path& file) {
  if (work) assign(work->file, file.native());
}

std::string_view workStage() { return work ? work->stage.data() : ""; }
std::string_view workProgram() { return work ? work->program.data() : ""; }
std::string_view workFile() { return work ? work->file.data() : ""; }

}  // namespace quintet::cli
