// SPDX-License-Identifier: Apache-2.0
// Messages of a page to the lab, and the targets of its requests.
#include <string>
#include <variant>

#include "lab/page_message.h"
#include "lab/request_target.h"
#include "target.h"

namespace quintet::fuzz {

void readInput(Input input) {
  const std::string_view text = textOf(input);
  const auto parsed = lab::parsePageMessage(text);
  if (const auto* error = std::get_if<lab::PageMessageError>(&parsed)) {
    if (error->message.empty()) reportFinding("an error has no text");
  } else {
    const lab::PageMessage& message = std::get<lab::PageMessage>(parsed);
    if (!lab::commandName(text)) reportFinding("the supervisor does not find the name of a valid command");
    if (const auto* open = std::get_if<lab::OpenSession>(&message.command))
      if (open->size && (open->size->x > 4096 || open->size->y > 4096 || open->size->x == 0))
        reportFinding("the size of the image is not within the limits");
  }
  if (const auto target = lab::parseTarget(text))
    if (!target->path.starts_with('/') || target->path.find('\0') != target->path.npos)
      reportFinding("the path of a request is not valid");
}

}  // namespace quintet::fuzz
