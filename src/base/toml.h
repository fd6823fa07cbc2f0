// The project's toml++ set-up: the only place that includes it, since its types and functions depend on these macros.
// For the layers that link quintet_tomlplusplus.
#ifndef QUINTET_BASE_TOML_H
#define QUINTET_BASE_TOML_H

#define TOML_EXCEPTIONS 1
#define TOML_ENABLE_FORMATTERS 0
// In debug builds the parser (3.3.0) asserts what malformed text does not keep, such as a value that begins with ','.
// Without the assertion it goes on to the error that it has for it.
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>

#endif
