// SPDX-License-Identifier: Apache-2.0
// The lecture programs of the source documents ($QUINTET_SHARED/seeds): cut from the text of a page, with the lines that the
// slides omit ("...") supplied. The documents are not part of the repository. tests/reference/run sets the variable; the tests
// are skipped without it. The lessons, with tests in tests/lessons, have programs of our own for the same subjects.
#ifndef QUINTET_TESTS_GPU_PROGRAM_SEEDS_H
#define QUINTET_TESTS_GPU_PROGRAM_SEEDS_H

#include <string>

#include "base/math.h"

namespace quintet::test {

// Returns the text of the document whose file name starts with `prefix` ("002"); empty if it is missing.
std::string seedDocument(const std::string& prefix);

#define QUINTET_NEED_SEED(variable, prefix)          \
  const std::string variable = seedDocument(prefix); \
  if (variable.empty()) GTEST_SKIP() << "QUINTET_SHARED is not set, or has no document " prefix

// Returns the text from occurrence number `which` (0-based) of `from` to the closing brace of the next `void main` whose
// body starts with the marker.
std::string cutProgram(const std::string& document, const std::string& from, int which, const std::string& marker);
// Returns the text from `from` to the end of the next block in braces.
std::string cutBlock(const std::string& document, const std::string& from);
// Returns the text from `from` up to `to`, exclusive.
std::string cutBetween(const std::string& document, const std::string& from, const std::string& to);

// Returns the text with its only line "..." replaced by the text that the slides omit.
std::string supplied(std::string program, const std::string& elided);

// Reference geometry in double precision.
using dvec2 = glm::dvec2;
using dvec3 = glm::dvec3;
struct RayD {
  dvec3 origin;
  dvec3 direction;
};
// The camera of document 002, at the origin, looking along -z.
dvec3 cameraDirection(double fovY, double aspect, const dvec2& point);
// Returns t of the ray at the parallelogram corner + u a + v b; infinity if it misses.
double hitParallelogram(const RayD& ray, const dvec3& corner, const dvec3& a, const dvec3& b);
// The radical inverse of the tables of document 002; the index starts at 1.
double halton(int base, int index);

}  // namespace quintet::test
#endif
