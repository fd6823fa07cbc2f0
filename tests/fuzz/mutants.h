// SPDX-License-Identifier: Apache-2.0
// Mutated programs: the programs of this repository with one to three changes to their tokens, statements, declarations or
// descriptions. A mutant depends only on the seed, its number and the sources.
#ifndef QUINTET_TESTS_FUZZ_MUTANTS_H
#define QUINTET_TESTS_FUZZ_MUTANTS_H

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace quintet::fuzz {

using Files = std::map<std::string, std::string>;

// A program as files: a folder with program.toml, or one lecture-form file with its siblings.
struct Source {
  std::string name;     // path relative to the root
  std::string lecture;  // name of the lecture-form file; empty for a folder
  Files files;
};

// The programs, lessons, examples, mistakes and idioms below the root of the repository, sorted by name.
std::vector<Source> findSources(const std::filesystem::path& root);

struct Mutant {
  const Source* source = nullptr;
  Files files;
  std::string changes;  // "main.rgen: deleted statement; …"
};

Mutant makeMutant(const std::vector<Source>& sources, std::uint64_t seed, std::uint64_t number);

}  // namespace quintet::fuzz
#endif
