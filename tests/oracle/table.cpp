// SPDX-License-Identifier: Apache-2.0
#include "table.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include <fmt/format.h>

#include "known_quirks.h"

namespace quintet::oracle {
namespace {

// "SkipsTheClosestHit" → "skips the closest hit"; "Has24Bits" → "has 24 bits"
std::string words(const std::string& name) {
  std::string text;
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    const bool inNumber = !text.empty() && std::isdigit(static_cast<unsigned char>(text.back()));
    if (!text.empty() && (std::isupper(u) || (std::isdigit(u) && !inNumber))) text += ' ';
    text += static_cast<char>(std::tolower(u));
  }
  return text;
}

std::string_view quirkText(std::string_view quirk) {
  for (const KnownQuirk& known : kAllQuirks)
    if (known.id == quirk) return known.text;
  return quirk;
}

}  // namespace

void TableListener::OnTestEnd(const testing::TestInfo& test) {
  Row row{test.test_suite_name(), test.name(), {}, {}, {}, {}};
  const testing::TestResult& result = *test.result();
  for (int k = 0; k < result.test_property_count(); ++k) {
    const testing::TestProperty& property = result.GetTestProperty(k);
    const std::string_view key = property.key();
    if (key == "values") row.values = property.value();
    if (key == "quirk") row.quirk = property.value();
    if (key == "wrong") row.wrong = property.value();
  }
  for (int k = 0; k < result.total_part_count(); ++k)
    if (result.GetTestPartResult(k).failed()) row.failure += std::string(result.GetTestPartResult(k).message()) + "\n";
  rows_.push_back(std::move(row));
}

std::string TableListener::markdown(const std::string& device) const {
  std::string text = fmt::format("| case ({}) | values | result |\n| --- | --- | --- |\n", device);
  std::string failures;
  std::size_t passed = 0, known = 0, failed = 0;
  for (const Row& row : rows_) {
    std::string result = "pass";
    if (!row.failure.empty()) {
      result = "**FAIL**";
      failures += fmt::format("\n{}.{}:\n{}", row.suite, row.name, row.failure);
      ++failed;
    } else if (!row.wrong.empty()) {
      result = fmt::format("known quirk, {} wrong: {}", row.wrong, quirkText(row.quirk));
      ++known;
    } else {
      ++passed;
    }
    text += fmt::format("| {}: {} | {} | {} |\n", words(row.suite), words(row.name), row.values, result);
  }
  return text + fmt::format("\n{} pass, {} known quirks, {} fail.\n", passed, known, failed) + failures;
}

std::vector<std::string> TableListener::untestedQuirks() const {
  std::vector<std::string> ids;
  for (const KnownQuirk& quirk : kAllQuirks)
    if (std::ranges::none_of(rows_, [&](const Row& row) { return row.quirk == quirk.id; })) ids.emplace_back(quirk.id);
  return ids;
}

}  // namespace quintet::oracle
