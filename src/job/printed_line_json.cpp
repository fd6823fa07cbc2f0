// SPDX-License-Identifier: Apache-2.0
#include "job/printed_line_json.h"

#include <nlohmann/json.hpp>

namespace quintet::job {

nlohmann::ordered_json printedLineJson(const PrintedLine& line) {
  nlohmann::ordered_json json{{"pixel", {line.pixel.x, line.pixel.y}}};
  if (line.frame) json["frame"] = *line.frame;
  if (line.sample) json["sample"] = *line.sample;
  json["stage"] = line.stage;
  json["file"] = line.location.file;
  json["line"] = line.location.line;
  json["text"] = line.text;
  return json;
}

}  // namespace quintet::job
