// SPDX-License-Identifier: Apache-2.0
// Compares the values of a device with those of the specification and evaluates the differences with known_quirks.h.
// Every test creates one Checks object and ends with a call of done().
#ifndef QUINTET_TESTS_ORACLE_CHECKS_H
#define QUINTET_TESTS_ORACLE_CHECKS_H

#include <cmath>
#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/math.h"
#include "known_quirks.h"

namespace quintet::oracle {

template <class T>
std::string textOf(const T& value) {
  if constexpr (requires {
                  value.length();
                  value[0];
                }) {
    std::string text;
    for (std::size_t k = 0; k < static_cast<std::size_t>(T::length()); ++k)
      text += fmt::format("{}{}", k ? " " : "", textOf(value[k]));
    return fmt::format("({})", text);
  } else {
    return fmt::format("{}", value);
  }
}

class Checks {
 public:
  Checks() = default;
  ~Checks();  // fails the test if done() was not called
  Checks(const Checks&) = delete;
  Checks& operator=(const Checks&) = delete;

  // These must be correct on every device.
  template <class T, class... A>
  void equal(const T& got, const std::type_identity_t<T>& expected, fmt::format_string<A...> what, A&&... arguments) {
    count(hard_, got == expected,
          [&] { return difference(got, expected, fmt::format(what, std::forward<A>(arguments)...)); });
  }
  // Fails for values that are not finite.
  template <class... A>
  void near(float got, float expected, float tolerance, fmt::format_string<A...> what, A&&... arguments) {
    count(hard_, std::abs(got - expected) <= tolerance,
          [&] { return difference(got, expected, fmt::format(what, std::forward<A>(arguments)...)); });
  }
  template <class... A>
  void near(const vec3& got, const vec3& expected, float tolerance, fmt::format_string<A...> what, A&&... arguments) {
    const vec3 error = glm::abs(got - expected);
    count(hard_, error.x <= tolerance && error.y <= tolerance && error.z <= tolerance,
          [&] { return difference(got, expected, fmt::format(what, std::forward<A>(arguments)...)); });
  }
  template <class... A>
  void that(bool right, fmt::format_string<A...> what, A&&... arguments) {
    count(hard_, right, [&] { return fmt::format(what, std::forward<A>(arguments)...); });
  }

  // Must be correct, except on drivers with the quirk passed to done(), where `documented` is also accepted.
  template <class T, class... A>
  void quirk(const T& got, const std::type_identity_t<T>& expected, const std::type_identity_t<T>& documented,
             fmt::format_string<A...> what, A&&... arguments) {
    const auto text = [&] { return difference(got, expected, fmt::format(what, std::forward<A>(arguments)...)); };
    got == documented || got == expected ? count(soft_, got == expected, text) : count(hard_, false, text);
  }
  // The same, but any wrong value is accepted on these drivers.
  template <class... A>
  void quirkThat(bool right, fmt::format_string<A...> what, A&&... arguments) {
    count(soft_, right, [&] { return fmt::format(what, std::forward<A>(arguments)...); });
  }

  void done() { finish(nullptr); }
  void done(const KnownQuirk& quirk) { finish(&quirk); }

 private:
  struct Tally {
    std::size_t total = 0, wrong = 0;
    std::vector<std::string> messages;  // the first kMessages
  };
  template <class Text>
  static void count(Tally& tally, bool right, const Text& text) {
    ++tally.total;
    if (right) return;
    ++tally.wrong;
    if (tally.messages.size() < kMessages) tally.messages.push_back(text());
  }
  template <class T>
  static std::string difference(const T& got, const T& expected, const std::string& what) {
    return fmt::format("{}: {} instead of {}", what, textOf(got), textOf(expected));
  }
  void finish(const KnownQuirk* quirk);

  static constexpr std::size_t kMessages = 8;
  Tally hard_, soft_;
  bool finished_ = false;
};

}  // namespace quintet::oracle
#endif
