// SPDX-License-Identifier: Apache-2.0
#include "lab/request_target.h"

#include <algorithm>

namespace quintet::lab {
namespace {

int digitOf(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<std::string> decode(std::string_view text, bool isQuery) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      if (i + 2 >= text.size()) return {};
      const int high = digitOf(text[i + 1]), low = digitOf(text[i + 2]);
      if (high < 0 || low < 0) return {};
      c = static_cast<char>(16 * high + low);
      i += 2;
    } else if (isQuery && c == '+') {
      c = ' ';
    }
    if (c == 0) return {};
    decoded += c;
  }
  return decoded;
}

}  // namespace

std::optional<std::string> decodePercent(std::string_view text) { return decode(text, false); }

std::optional<RequestTarget> parseTarget(std::string_view target) {
  if (!target.starts_with('/')) return {};
  RequestTarget result;
  const std::size_t mark = target.find('?');
  const std::optional<std::string> path = decode(target.substr(0, mark), false);
  if (!path) return {};
  result.path = *path;
  std::string_view rest = mark == target.npos ? std::string_view() : target.substr(mark + 1);
  while (!rest.empty()) {
    const std::string_view item = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), item.size() + 1));
    const std::size_t equals = item.find('=');
    const std::optional<std::string> name = decode(item.substr(0, equals), true);
    const std::optional<std::string> value =
        equals == item.npos ? std::optional<std::string>("") : decode(item.substr(equals + 1), true);
    if (!name || !value) return {};
    result.query[*name] = *value;
  }
  return result;
}

}  // namespace quintet::lab
