// SPDX-License-Identifier: Apache-2.0
// debugPrintfEXT: stores the number of a call and the words of its arguments in the shader log. program::addProbes inserts
// this file before a stage that prints and a new main() after it; spirv::replacePrintCalls then replaces the calls of
// debugPrintfEXT by calls of these functions.
#ifndef QUINTET_PRINT_GLSL
#define QUINTET_PRINT_GLSL

#include "log.glsl"

// Return the position of the next word. Parameters are const so that SPIR-V passes values, not pointers.
uint printBegin_(const uint number, const uint wordCount) {
  uint at = logBegin_(kLogPrint, wordCount + 1u);
  logWord_(at, number);
  return at;
}
uint printWord_(const uint at, const uint word) {
  uint next = at;
  logWord_(next, word);
  return next;
}

// The new main() calls this function, so that the compiler keeps the others. The call is removed, too.
void printKeep_() { printWord_(printBegin_(0u, 0u), 0u); }

#endif
