// SPDX-License-Identifier: Apache-2.0
// Files that are compiled into the binary (shader library, built-in programs); see cmake/QuintetEmbed.cmake.
#ifndef QUINTET_BASE_EMBEDDED_H
#define QUINTET_BASE_EMBEDDED_H

#include <span>
#include <string_view>

namespace quintet {

struct EmbeddedFile {
  std::string_view path;  // relative, with '/' separators; a set of files is sorted by path
  std::string_view data;
};

}  // namespace quintet
#endif
