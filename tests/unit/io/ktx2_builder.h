// SPDX-License-Identifier: Apache-2.0
// Builds small KTX2 files in tests.
#ifndef QUINTET_TESTS_IO_KTX2_BUILDER_H
#define QUINTET_TESTS_IO_KTX2_BUILDER_H

#include <cstdint>
#include <initializer_list>
#include <string>

#include "io/samples.h"

namespace quintet::io::test {

// A file of one level. The members can be changed before build().
struct Ktx2 {
  std::uint32_t format = 37, width = 1, height = 1, depth = 0, layers = 0, faces = 1, scheme = 0;
  Bytes level;
  std::uint64_t statedSize = 0;  // 0: that of `level`
  std::string keys;              // key/value data
  Bytes descriptor, globalData;  // of the data format, and of the supercompression

  // Adds an entry to the key/value data.
  void addKey(const std::string& key, const std::string& value);
  // Sets the data format descriptor: a color model, flags, and the channel of each sample.
  void describe(std::uint32_t model, std::initializer_list<int> channels, std::uint32_t flags = 0);
  // Compresses the level as `scheme` states: 2 for Zstandard, 3 for zlib.
  Bytes build() const;
};

}  // namespace quintet::io::test
#endif
