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

void Ktx2::describe(std::uint32_t model, std::initializer_list<int> channels, std::uint32_t flags) {
  descriptor.assign(28 + 16 * channels.size(), std::byte{0});
  const auto set = [&](std::size_t at, std::size_t value) { descriptor[at] = static_cast<std::byte>(value); };
  set(0, descriptor.size()), set(8, 2), set(10, descriptor.size() - 4);
  set(12, model), set(13, 1), set(14, 2), set(15, flags), set(16, 3), set(17, 3);
  std::size_t sample = 28;
  for (const int channel : channels) {
    set(sample + 3, static_cast<std::size_t>(channel));
    sample += 16;
  }
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
  const auto size32 = [](const auto& bytes) { return static_cast<std::uint32_t>(bytes.size()); };
  const std::uint32_t descriptorOffset = descriptor.empty() ? 0 : 104, keyOffset = 104 + size32(descriptor);
  const std::uint32_t words[] = {
      format,    1,           width, height, depth, layers, faces, 1, scheme, descriptorOffset, size32(descriptor),
      keyOffset, size32(keys)};
  std::memcpy(file.data() + 12, words, sizeof words);
  const std::uint64_t globalOffset = globalData.empty() ? 0 : keyOffset + keys.size();
  const std::uint64_t stated = scheme == 1 ? 0 : statedSize ? statedSize : level.size();
  const std::uint64_t sizes[] = {globalOffset, globalData.size(), keyOffset + keys.size() + globalData.size(),
                                 stored.size(), stated};
  std::memcpy(file.data() + 64, sizes, sizeof sizes);
  file.insert(file.end(), descriptor.begin(), descriptor.end());
  for (const char c : keys) file.push_back(static_cast<std::byte>(c));
  file.insert(file.end(), globalData.begin(), globalData.end());
  file.insert(file.end(), stored.begin(), stored.end());
  return file;
}

}  // namespace quintet::io::test
