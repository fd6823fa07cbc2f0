// SPDX-License-Identifier: Apache-2.0
// The inputs from which the libFuzzer targets start: small valid files that together use all features of a format.
#ifndef QUINTET_TESTS_FUZZ_SEEDS_H
#define QUINTET_TESTS_FUZZ_SEEDS_H

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace quintet::fuzz {

struct Seed {
  std::string name;  // of the file, unique in its corpus
  std::vector<std::byte> bytes;
};

// By the name of the target. The same bytes in each run.
using Corpora = std::map<std::string, std::vector<Seed>>;

void addImageSeeds(Corpora&);  // png, jpeg, webp, hdr, exr, ktx2
void addGltfSeeds(Corpora&);   // gltf, glb
void addFilmSeeds(Corpora&);   // film
void addLabSeeds(Corpora&);    // lab_message, lab_zip
// spirv, modules: stages of the programs in `root`/tests/check/idioms that include no library; modules: also HLSL, Slang and hit
// objects (tests/check/modules, tests/check/engines). Throws Error if there is none.
void addSpirvSeeds(Corpora&, const std::filesystem::path& root);

}  // namespace quintet::fuzz
#endif
