// SPDX-License-Identifier: Apache-2.0
// Diagnostics as SARIF 2.1.0 (Static Analysis Results Interchange Format, OASIS), which editors and CI read.
#ifndef QUINTET_CHECK_SARIF_H
#define QUINTET_CHECK_SARIF_H

#include <string>
#include <vector>

#include "check/sources.h"
#include "check/suppression.h"

namespace quintet::check {

// Returns one line with a log of one run. `version` is that of Quintet. Rules come from the catalog, with the pages of
// docs/diagnostics as help; only those that a result uses. Columns count code points, for which `sources` is read.
// `complete`: executionSuccessful of the invocation; false for a log that is replaced unless the process crashes.
std::string sarifText(const std::vector<Diagnostic>& diagnostics, const std::vector<SuppressedDiagnostic>& suppressed,
                      const SourceLookup& sources, const std::string& version, bool complete);

}  // namespace quintet::check
#endif
