// Text for people on standard error. Whether anybody reads it does not matter: a job goes on when its terminal is closed or
// the program behind a pipe has ended, where fmt::print would throw.
#ifndef QUINTET_APP_STANDARD_ERROR_H
#define QUINTET_APP_STANDARD_ERROR_H

#include <cstdio>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace quintet::app {

template <class... Values>
void printError(fmt::format_string<Values...> format, Values&&... values) {
  const std::string text = fmt::format(format, std::forward<Values>(values)...);
  [[maybe_unused]] const std::size_t written = std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace quintet::app
#endif
