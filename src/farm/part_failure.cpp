// SPDX-License-Identifier: Apache-2.0
#include "farm/part_failure.h"

#include <unistd.h>

#include <array>
#include <system_error>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/json.h"

namespace quintet::farm {

std::string machineName() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 && name[0] != 0 ? name.data() : "this machine";
}

void recordFailure(const Plan& plan, std::size_t part, const PartFailure& failure) {
  using Json = nlohmann::ordered_json;
  const Json json{{"machine", failure.machine}, {"message", failure.message}, {"status", failure.status}};
  try {
    writeFile(failureFile(plan, part), json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  } catch (const FileError&) {  // the message is in the log
  }
}

void removeFailure(const Plan& plan, std::size_t part) {
  std::error_code ignored;
  std::filesystem::remove(failureFile(plan, part), ignored);
}

std::optional<PartFailure> readFailure(const Plan& plan, std::size_t part) {
  std::error_code ignored;
  if (!std::filesystem::exists(failureFile(plan, part), ignored)) return std::nullopt;
  try {
    const nlohmann::json json = parseJson(failureFile(plan, part), readTextFile(failureFile(plan, part)));
    return PartFailure{json.at("machine").get<std::string>(), json.at("message").get<std::string>(),
                       json.at("status").get<int>()};
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  } catch (const FileError&) {
    return std::nullopt;
  }
}

}  // namespace quintet::farm
