// SPDX-License-Identifier: Apache-2.0
// Unsigned integers in the headers of messages and zip files: little endian, `size` bytes.
#ifndef QUINTET_LAB_LITTLE_ENDIAN_H
#define QUINTET_LAB_LITTLE_ENDIAN_H

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace quintet::lab {

inline void appendInteger(std::string& bytes, std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i));
}

// `bytes` must contain them.
inline std::uint64_t integerAt(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

}  // namespace quintet::lab
#endif
