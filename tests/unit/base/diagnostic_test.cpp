// SPDX-License-Identifier: Apache-2.0
// Text forms of diagnostics, and lists without duplicates.
#include "base/diagnostic.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace quintet {
namespace {

TEST(Diagnostic, FormatsKnownParts) {
  EXPECT_EQ((Diagnostic{Severity::error, "a.rgen", 3, 7, "GLSL", "bad"}.format()), "a.rgen:3:7: error: bad [GLSL]");
  EXPECT_EQ((Diagnostic{Severity::warning, "a.rgen", 3, 0, "Q101", "odd"}.format()), "a.rgen:3: warning: odd [Q101]");
  EXPECT_EQ((Diagnostic{Severity::note, "a.rgen", 0, 0, "", "so"}.format()), "a.rgen: note: so");
  EXPECT_EQ((Diagnostic{Severity::error, "", 0, 0, "", "no"}.format()), "error: no");
}

TEST(Diagnostic, ConvertsFileErrors) {
  const Diagnostic toml = asDiagnostic(FileError("p/program.toml", "line 12", "no such key"));
  EXPECT_EQ(toml.format(), "p/program.toml:12: error: no such key [FILE]");
  const Diagnostic gltf = asDiagnostic(FileError("s.gltf", "/nodes/0", "is bad"));
  EXPECT_EQ(gltf.format(), "s.gltf: error: /nodes/0: is bad [FILE]");
}

TEST(Diagnostic, CountsErrorsAndWarnings) {
  const Diagnostic e{Severity::error, "", 0, 0, "", ""}, w{Severity::warning, "", 0, 0, "", ""},
      n{Severity::note, "", 0, 0, "", ""};
  EXPECT_EQ(countText({e, w, w, n}), "1 error, 2 warnings");
  EXPECT_EQ(countText({w}), "1 warning");
  EXPECT_EQ(countText({n}), "");
}

TEST(Diagnostic, AddsEqualDiagnosticsOnce) {
  std::vector<Diagnostic> list;
  const Diagnostic first{Severity::error, "a.rgen", 3, 7, "Q101", "bad"};
  Diagnostic otherLine = first, otherText = first;
  otherLine.line = 4;
  otherText.text = "worse";
  for (const Diagnostic& d : {first, first, otherLine, otherText, first}) addUnique(list, d);
  EXPECT_EQ(list.size(), 3u);
}

}  // namespace
}  // namespace quintet
