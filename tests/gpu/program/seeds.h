// The lecture programs of the source documents (../shared/seeds, beside the repository): cut out of the page's text, with
// what the slides leave out ("...") supplied. They are not part of the repository; tests skip where they are absent.
#ifndef QUINTET_TESTS_GPU_PROGRAM_SEEDS_H
#define QUINTET_TESTS_GPU_PROGRAM_SEEDS_H

#include <string>

#include "base/math.h"

namespace quintet::test {

// The text of the document whose file name begins with `prefix` ("002"); empty: it is not there.
std::string seedDocument(const std::string& prefix);

#define QUINTET_NEED_SEED(variable, prefix)          \
  const std::string variable = seedDocument(prefix); \
  if (variable.empty()) GTEST_SKIP() << "document " prefix " is not there"

// From the `which`-th (from 0) occurrence of `from` up to and with the end of the next `void main` whose body begins with
// the marker, by its braces.
std::string cutProgram(const std::string& document, const std::string& from, int which, const std::string& marker);
// From `from` to the end of the block in braces behind it.
std::string cutBlock(const std::string& document, const std::string& from);
// From `from` up to `to`, which is left out.
std::string cutBetween(const std::string& document, const std::string& from, const std::string& to);

// The text with its only line "..." replaced: what the slides leave out.
std::string supplied(std::string program, const std::string& elided);

// Reference geometry in double precision.
using dvec2 = glm::dvec2;
using dvec3 = glm::dvec3;
struct RayD {
  dvec3 origin;
  dvec3 direction;
};
// Document 002's camera, at the origin, towards -z.
dvec3 cameraDirection(double fovY, double aspect, const dvec2& point);
// Parallelogram corner + u a + v b: the ray's t, or infinity.
double hitParallelogram(const RayD& ray, const dvec3& corner, const dvec3& a, const dvec3& b);
// Base 2 and 3, as the tables of document 002 say; index from 1.
double halton(int base, int index);

}  // namespace quintet::test
#endif
