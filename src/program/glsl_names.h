// Which names a program may give to things that become names in GLSL.
#ifndef QUINTET_PROGRAM_GLSL_NAMES_H
#define QUINTET_PROGRAM_GLSL_NAMES_H

#include <string>

namespace quintet::program {

// Letters, digits and '_', no digit first, not "gl_…", no "__" (GLSL 4.60, 3.7); so that kRay_NAME is an identifier.
bool isIdentifier(const std::string& name);

// A word that cannot be the member of a struct: GLSL's keywords and the library's macros.
bool isReservedWord(const std::string& name);

}  // namespace quintet::program
#endif
