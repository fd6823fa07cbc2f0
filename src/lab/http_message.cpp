// SPDX-License-Identifier: Apache-2.0
#include "lab/http_message.h"

#include <nlohmann/json.hpp>

namespace quintet::lab {

HttpResponse errorResponse(unsigned status, const std::string& message,
                           const std::vector<std::pair<std::string, std::string>>& members) {
  using Json = nlohmann::ordered_json;
  Json json{{"error", message}};
  for (const auto& [name, value] : members) json[name] = Json::parse(value);
  return {.status = status, .body = json.dump(-1, ' ', false, Json::error_handler_t::replace)};
}

}  // namespace quintet::lab
