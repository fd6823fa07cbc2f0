// SPDX-License-Identifier: Apache-2.0
#include "seeds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "base/file.h"

namespace quintet::test {

std::string seedDocument(const std::string& prefix) {
  const char* shared = std::getenv("QUINTET_SHARED");
  if (!shared) return {};
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(shared) / "seeds"))
    if (entry.path().filename().string().starts_with(prefix)) return readTextFile(entry.path());
  return {};
}

namespace {

// Returns the offset after the block that opens at or after `at`.
std::size_t endOfBlock(const std::string& text, std::size_t at) {
  int depth = 0;
  for (; at < text.size(); ++at) {
    if (text[at] == '{') ++depth;
    if (text[at] == '}' && --depth == 0) return at + 1;
  }
  ADD_FAILURE() << "unterminated block";
  return text.size();
}

std::size_t find(const std::string& text, const std::string& what, std::size_t from = 0) {
  const std::size_t at = text.find(what, from);
  EXPECT_NE(at, std::string::npos) << "'" << what << "' not found in the document";
  return std::min(at, text.size());
}

}  // namespace

std::string cutProgram(const std::string& document, const std::string& from, int which, const std::string& marker) {
  std::size_t begin = find(document, from);
  for (; which > 0; --which) begin = find(document, from, begin + 1);
  const std::size_t mark = find(document, marker, begin);
  return document.substr(begin, endOfBlock(document, document.rfind("main()", mark)) - begin);
}

std::string cutBlock(const std::string& document, const std::string& from) {
  const std::size_t begin = find(document, from);
  return document.substr(begin, endOfBlock(document, begin) - begin);
}

std::string cutBetween(const std::string& document, const std::string& from, const std::string& to) {
  const std::size_t begin = find(document, from);
  return document.substr(begin, find(document, to, begin) - begin);
}

std::string supplied(std::string program, const std::string& elided) {
  const std::size_t at = find(program, "\n...");
  EXPECT_EQ(program.find("\n...", at + 1), std::string::npos);
  return program.replace(at, 4, "\n" + elided);
}

dvec3 cameraDirection(double fovY, double aspect, const dvec2& point) {
  const dvec2 p = 2.0 * point - 1.0;
  return glm::normalize(dvec3(p.x * aspect, p.y, -1.0 / std::tan(glm::radians(fovY) / 2.0)));
}

double hitParallelogram(const RayD& ray, const dvec3& corner, const dvec3& a, const dvec3& b) {
  const dvec3 n = glm::cross(a, b);
  const double t = glm::dot(corner - ray.origin, n) / glm::dot(ray.direction, n);
  const dvec3 p = ray.origin + t * ray.direction - corner;
  const double u = glm::dot(glm::cross(p, b), n) / glm::dot(n, n), v = glm::dot(glm::cross(a, p), n) / glm::dot(n, n);
  return u >= 0 && u <= 1 && v >= 0 && v <= 1 ? t : std::numeric_limits<double>::infinity();
}

double halton(int base, int index) {
  double value = 0, digit = 1.0 / base;
  for (; index > 0; index /= base, digit /= base) value += digit * (index % base);
  return value;
}

}  // namespace quintet::test
