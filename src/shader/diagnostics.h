// From the compiler's messages to Diagnostics.
#ifndef QUINTET_SHADER_DIAGNOSTICS_H
#define QUINTET_SHADER_DIAGNOSTICS_H

#include "shader/include_resolver.h"

namespace quintet::shader {

// Parses shaderc's text: lines "name:line: error: …", "name: warning: …"; a line of another form
// continues the message before it. Names that the resolver knows may contain colons.
std::vector<Diagnostic> parseMessages(std::string_view messages, const IncludeResolver& files);

// Leaves out what follows from another error: everything but the include if a file is missing, and
// all but the first error of a line (an undeclared name makes glslang complain about every operator).
void dropConsequences(std::vector<Diagnostic>& diagnostics);

// Says in words what SPIR-V's validation, which runs before spirv-opt, means by a rayPayloadEXT in a stage that cannot
// trace (Q103), and where that is.
void explainPayloadOfAnotherStage(std::vector<Diagnostic>& diagnostics, Stage stage, const IncludeResolver& files);

// Column of the only occurrence of the token that the message quotes ("'token' : undeclared …") in
// its line; 0 if there is none or more than one.
int columnOfToken(std::string_view text, int line, std::string_view message);

}  // namespace quintet::shader
#endif
