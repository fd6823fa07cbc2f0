// SPDX-License-Identifier: Apache-2.0
// Reads the members of a JSON object, and rejects those that nothing reads. All functions throw UsageError that names
// the member.
#ifndef QUINTET_JOB_INTERACTIVE_JSON_FIELDS_H
#define QUINTET_JOB_INTERACTIVE_JSON_FIELDS_H

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "base/math.h"

namespace quintet::job::interactive {

class JsonFields {
 public:
  // `text`: one object
  explicit JsonFields(std::string_view text);

  bool has(const std::string& name);
  std::string text(const std::string& name);
  std::optional<std::string> findText(const std::string& name);
  double number(const std::string& name);
  std::optional<double> findNumber(const std::string& name);
  std::optional<bool> findFlag(const std::string& name);
  float real(const std::string& name, float otherwise);
  std::uint32_t count(const std::string& name);  // a whole number from 1 on
  std::uint32_t index(const std::string& name);  // a whole number from 0 on
  std::vector<double> numbers(const std::string& name, std::size_t count);
  std::optional<vec3> findPoint(const std::string& name);
  // A number, true, false, a text, or a list of numbers as in "name=value": "3", "true", "0.5,1,0".
  std::string assignedValue(const std::string& name);
  // Numbers of each member that nothing has read, with its name: a number, true, false, or a list of numbers.
  std::vector<std::pair<std::string, std::vector<double>>> otherNumbers();

  // Throws UsageError if the object has a member that none of the functions was asked for.
  void rejectOthers() const;

 private:
  const nlohmann::json* find(const std::string& name);
  const nlohmann::json& require(const std::string& name);
  std::uint32_t whole(const std::string& name, double min);

  nlohmann::json object_;
  std::vector<std::string> known_;
};

}  // namespace quintet::job::interactive
#endif
