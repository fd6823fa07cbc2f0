// SPDX-License-Identifier: Apache-2.0
#include "io/ktx2_builder.h"

#include <zlib.h>
#include <zstd.h>

#include <cstring>

namespace quintet::io::test {

void Ktx2::addKey(const std::string& key, const std::string& value) {
  const std::string entry = key + '\0' + value + '\0';
  const auto size = static_cast<std::uint32_t>(entry.size());
  keys.append(reinterpret_cast<const char*>(&size), 4);
  keys += entry + std::string((4 - entry.size() % 4) % 4, '\0');
}

Bytes Ktx2::build() const {
  Bytes stored = level;
  if (scheme == 2) {
    stored.resize(ZSTD_compressBound(level.size()));
    stored.resize(ZSTD_compress(stored.data(), stored.size(), level.data(), level.size(), 3));
  } else if (scheme == 3) {
    uLongf size = compressBound(level.size());
    stored.resize(size);
    compress(reinterpret_cast<Bytef*>(stored.data()), &size, reinterpret_cast<const Bytef*>(level.data()),
             level.size());
    stored.resize(size);
  }
  Bytes file(104);
  const std::string_view identifier("\xABKTX 20\xBB\r\n\x1A\n", 12);
  std::memcpy(file.data(), identifier.data(), identifier.size());
  const std::uint32_t keyOffset = 104, keyLength = static_cast<std::uint32_t>(keys.size());
  const std::uint32_t words[] = {format, 1, width, height, depth, layers, faces, 1, scheme, 0, 0, keyOffset, keyLength};
  std::memcpy(file.data() + 12, words, sizeof words);
  const std::uint64_t sizes[] = {104 + keys.size(), stored.size(), statedSize ? statedSize : level.size()};
  std::memcpy(file.data() + 80, sizes, sizeof sizes);
  for (const char c : keys) file.push_back(static_cast<std::byte>(c));
  file.insert(file.end(), stored.begin(), stored.end());
  return file;
}

}  // namespace quintet::io::test
