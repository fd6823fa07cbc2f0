// SPDX-License-Identifier: Apache-2.0
// Checks messages against the descriptions in files such as session_protocol.json. web/build/protocol.mjs makes the types of
// the page and the tables of the documentation from the same files.
//
// A file has objects by name in these members:
//   "commands", "events"   messages: {"do": NAME, …} and {"event": NAME, …}
//   "types"                types that fields refer to by name
//   "common"               fields of every message
//
// A message or a type with fields has:
//   "fields"      fields by name: {"type": TYPE} and the keys below; or TYPE alone
//   "others"      type of all further members
//   "together"    two fields that require each other
//   "atLeastOne"  true: one of the optional fields or of the further members is required
//   "help"        Markdown for the documentation
//
// Other types have "is", a TYPE; "values", a list of texts; or "module", the file of the page that describes an object,
// whose members are not checked.
//
// TYPE is one of these words or the name of a type, with [] for a list, [3] for a list of three, and {} for an object whose
// members have the type. | separates alternatives. ? at the end means that the field can be missing.
//   text, number, flag, null, object
//   whole   whole number from 0 to 2^53
//   index   whole number from 0 to 2^24
//   count   whole number from 1 to 2^24
//
// Further keys of a field:
//   "default"        value of a field that is missing
//   "max", "above"   the largest value; a limit that the value must exceed
//   "unit", "help", "otherwise"   for the documentation: unit, explanation, what a missing field means
#ifndef QUINTET_JOB_INTERACTIVE_MESSAGE_SCHEMA_H
#define QUINTET_JOB_INTERACTIVE_MESSAGE_SCHEMA_H

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace quintet::job::interactive {

class MessageSchema {
 public:
  // `files`: their texts. Later ones add messages and types, or replace those of earlier ones.
  explicit MessageSchema(const std::vector<std::string_view>& files);

  // Returns a command with the defaults of the fields that are missing. Throws UsageError that names the field.
  nlohmann::json readCommand(std::string_view text) const;
  nlohmann::json completeCommand(nlohmann::json message) const;

  // Throws UsageError for an event that differs from its description. Tests call it.
  void checkEvent(nlohmann::json event) const;

  // The file of all types and messages, merged.
  const nlohmann::ordered_json& content() const { return content_; }

 private:
  nlohmann::ordered_json content_;
};

}  // namespace quintet::job::interactive
#endif
