#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the reference of the C++ API: build/docs/html/index.html. Warnings are errors, and so is a class, struct, enumeration
# or function without a comment. Exit status: 1 for problems, 77 if Doxygen is not installed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if ! command -v doxygen >/dev/null; then
    echo "docs: Doxygen is not installed"
    exit 77
fi
mkdir -p build/docs
doxygen docs/api/Doxyfile

# What Doxygen misses in the comments. Members of structs can be clear without one.
missing=$( (cat docs/api/Doxyfile; echo "WARN_IF_UNDOCUMENTED = YES"; echo "WARN_AS_ERROR = NO"; echo "GENERATE_HTML = NO";
    echo "GENERATE_XML = YES") | doxygen - 2>&1 | grep -E 'Compound .* is not documented|\((enumeration|function)\).*is not documented' |
    grep -vE 'operator|noexcept|Member (Device|Scene|Error|[A-Za-z]*Error)\(' || true)
if [[ -n $missing ]]; then
    echo "$missing"
    echo "docs: declarations without a comment"
    exit 1
fi
echo "docs: build/docs/html/index.html"
