// SPDX-License-Identifier: Apache-2.0
// What `quintet compare` prints: measures of two images, or the test of two films.
#ifndef QUINTET_OUTPUT_COMPARISON_REPORT_H
#define QUINTET_OUTPUT_COMPARISON_REPORT_H

#include <span>
#include <string>
#include <vector>

#include "io/compare.h"
#include "job/film_comparison.h"

namespace quintet::output {

struct Measure {
  std::string name;     // "mae8"
  std::string meaning;  // "mean absolute difference, in steps of 1/255"
  double value = 0;
  bool largerIsBetter = false;
  bool meets(double limit) const { return largerIsBetter ? value >= limit : value <= limit; }
};
std::vector<Measure> measures(const io::Comparison& comparison);

// One line for each measure, and the number of pixels that are not finite.
std::string comparisonText(const io::Comparison& comparison);
// `a`, `b`: names of the files. Measures that are not finite (psnr of equal images) are null.
std::string comparisonJson(const io::Comparison& comparison, const std::string& a, const std::string& b, uvec2 size);

std::string comparisonText(const job::FilmComparison& comparison);
std::string comparisonJson(const job::FilmComparison& comparison);
// Why the test rejects, on one line.
std::string rejectionText(const job::FilmComparison& comparison);

}  // namespace quintet::output
#endif
