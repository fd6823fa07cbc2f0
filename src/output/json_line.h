// SPDX-License-Identifier: Apache-2.0
// JSON that scripts read line by line.
#ifndef QUINTET_OUTPUT_JSON_LINE_H
#define QUINTET_OUTPUT_JSON_LINE_H

#include <string>

#include <nlohmann/json.hpp>

namespace quintet::output {

// `json` in one line, which ends with "\n". Bytes that are not UTF-8 become U+FFFD.
inline std::string jsonLine(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace quintet::output
#endif
