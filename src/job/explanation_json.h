// SPDX-License-Identifier: Apache-2.0
// A PixelExplanation as one JSON object, and back. Numbers that are not finite are the texts "nan", "inf" and "-inf".
#ifndef QUINTET_JOB_EXPLANATION_JSON_H
#define QUINTET_JOB_EXPLANATION_JSON_H

#include <filesystem>
#include <string>

#include "job/pixel_explanation.h"

namespace quintet::job {

// With a line break at the end. `command`: that reproduces the explanation; may be empty.
std::string explanationJson(const PixelExplanation& explanation, const std::string& command = {});

// Reads what explanationJson() wrote. Throws FileError with the location, a JSON pointer.
PixelExplanation readExplanation(const std::filesystem::path& file);
// The same from a text; `file` is its name in errors.
PixelExplanation parseExplanation(const std::string& text, const std::filesystem::path& file);

}  // namespace quintet::job
#endif
