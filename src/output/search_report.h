// SPDX-License-Identifier: Apache-2.0
// What `quintet find` prints: the samples that were found, each with the command that explains it.
#ifndef QUINTET_OUTPUT_SEARCH_REPORT_H
#define QUINTET_OUTPUT_SEARCH_REPORT_H

#include <cstddef>
#include <functional>
#include <string>

#include "job/sample_search.h"

namespace quintet::output {

// The command that explains a sample: `quintet explain-pixel` with the options of the render.
using CommandFor = std::function<std::string(const job::FoundSample&)>;

// `width`: of the terminal.
std::string searchText(const job::SearchResult& result, const CommandFor& commandFor, std::size_t width);
// One line.
std::string searchJson(const job::SearchResult& result, const CommandFor& commandFor);

}  // namespace quintet::output
#endif
