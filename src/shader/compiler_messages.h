// SPDX-License-Identifier: Apache-2.0
// Turns the messages of shaderc into diagnostics.
#ifndef QUINTET_SHADER_COMPILER_MESSAGES_H
#define QUINTET_SHADER_COMPILER_MESSAGES_H

#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "shader/include_resolver.h"
#include "shader/stage.h"

namespace quintet::shader {

// Parses the text of shaderc: lines such as "name:line: error: …" and "name: warning: …". Any other line continues the
// message before it. The names of files that the resolver knows can contain colons.
std::vector<Diagnostic> parseMessages(std::string_view messages, const IncludeResolver& files);

// Removes errors that follow from earlier ones: all other errors if an include is missing, and all but the first
// error of a line (an undeclared name causes an error for each operator).
void dropFollowUpErrors(std::vector<Diagnostic>& diagnostics);

// Explains the message of SPIR-V validation, which runs before spirv-opt, about a rayPayloadEXT in a stage that cannot
// trace, and adds its location (Q103).
void explainOutgoingPayload(std::vector<Diagnostic>& diagnostics, Stage stage, const IncludeResolver& files);

// Returns the column of the token that the message quotes ("'token' : undeclared …") in its line; 0 unless the token
// occurs exactly once.
int columnOfToken(std::string_view text, int line, std::string_view message);

}  // namespace quintet::shader
#endif
