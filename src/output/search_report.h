// SPDX-License-Identifier: Apache-2.0
// What `quintet find` prints: the samples that were found, each with the command that explains it.
#ifndef QUINTET_OUTPUT_SEARCH_REPORT_H
#define QUINTET_OUTPUT_SEARCH_REPORT_H

#include <cstddef>
#include <string>

#include "job/sample_search.h"

namespace quintet::output {

// `command`: `quintet explain-pixel` with the options of the render, without pixel and sample. `width`: of the terminal.
std::string searchText(const job::SearchResult& result, const std::string& command, std::size_t width);
// One line.
std::string searchJson(const job::SearchResult& result, const std::string& command);

}  // namespace quintet::output
#endif
