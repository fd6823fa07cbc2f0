#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copies excerpts of source files into Markdown pages, so that the code of a page is the code that the tests run.
#   scripts/excerpts.sh [PAGE…]            updates the pages (default: all pages below docs/ with an excerpt)
#   scripts/excerpts.sh --check [PAGE…]    only reports excerpts that differ from their source; exit status 1 if any
#   scripts/excerpts.sh --self-test        shows that differences and wrong markers are found
#
# A page marks an excerpt by a comment before a code block. The file is relative to the root of the repository:
#   <!-- excerpt: FILE from "TEXT" to "TEXT" -->
# A text that contains double quotes is in single quotes.
# The excerpt starts at the only line that contains the first text, and ends at the next line that contains the second one.
# Without `to`, it ends where the braces that it opens are closed. Common indentation is removed.
# shellcheck disable=SC2016  # backquotes in single quotes are Markdown
set -euo pipefail
script=$(realpath "${BASH_SOURCE[0]}")
root=${EXCERPTS_ROOT-$(dirname "$script")/..}

# fill PAGE: prints the page with current excerpts. Reports errors with file and line and returns 1.
fill() {
  awk -v page="$1" -v root="$root" '
    function fail(text) { printf "%s:%d: %s\n", page, NR, text > "/dev/stderr"; failed = 1 }
    # quoted(NAME): the text in quotes after the word NAME of the marker; empty if it is missing.
    function quoted(name,   start, quote, rest) {
      if (!match(marker, " " name " [\"\047]")) return ""
      quote = substr(marker, RSTART + RLENGTH - 1, 1)
      rest = substr(marker, RSTART + RLENGTH)
      return substr(rest, 1, index(rest, quote) - 1)
    }
    function copy(   file, from, to, n, i, k, first, last, depth, opened, indent, shortest, path, line, count) {
      file = marker
      sub(/^<!-- excerpt: /, "", file)
      sub(/ .*/, "", file)
      from = quoted("from"); to = quoted("to")
      path = root "/" file
      n = 0
      while ((getline line < path) > 0) lines[++n] = line
      close(path)
      if (!n) { fail("no file " file); return }
      for (i = 1; i <= n; ++i) if (from != "" && index(lines[i], from)) { count++; first = i }
      if (count != 1) { fail(sprintf("%s: \"%s\" is in %d lines, expected 1", file, from, count)); return }
      last = 0
      for (i = first; i <= n && !last; ++i) {
        if (to != "") { if (index(lines[i], to)) last = i; continue }
        for (k = 1; k <= length(lines[i]); ++k) {
          if (substr(lines[i], k, 1) == "{") { depth++; opened = 1 }
          if (substr(lines[i], k, 1) == "}") depth--
        }
        if (opened && depth <= 0) last = i
      }
      if (!last) { fail(file ": the end of the excerpt is missing"); return }
      shortest = 1000
      for (i = first; i <= last; ++i) {
        if (lines[i] == "") continue
        match(lines[i], /^ */)
        if (RLENGTH < shortest) shortest = RLENGTH
      }
      for (i = first; i <= last; ++i) print substr(lines[i], shortest + 1)
    }
    /^<!-- excerpt: / {
      marker = $0
      print
      language = marker ~ /\.toml / ? "toml" : "glsl"
      print "```" language
      copy()
      print "```"
      pending = 1
      next
    }
    pending && /^```/ { pending = 0; inside = 1; next }
    inside { if (/^```$/) inside = 0; next }
    { pending = 0; print }
    END { exit failed }' "$1"
}

if [ "${1-}" = --self-test ]; then
  scratch=$(mktemp -d)
  trap 'rm -rf "$scratch"' EXIT
  cd "$scratch"
  export EXCERPTS_ROOT=$scratch
  printf 'int a = "x";\n  void f() {\n    if (a) { g(); }\n  }\nint b;\nint b2;\n' > code.glsl
  printf 'Text.\n\n<!-- excerpt: code.glsl from "void f" -->\n\nMore.\n<!-- excerpt: code.glsl from \047= "x"\047 to "void f" -->\n```glsl\nold\n```\nEnd.\n' > page.md
  ! bash "$script" --check page.md 2>/dev/null || { echo "an old excerpt was not found" >&2; exit 1; }
  bash "$script" page.md
  bash "$script" --check page.md
  expected=$'void f() {\n  if (a) { g(); }\n}'
  text=$(cat page.md)
  if [[ $text != *"$expected"* || $text == *old* || $text != *$'\n\nMore.\n'* || $text != *End. ]]; then
    echo "wrong page:" >&2
    cat page.md >&2
    exit 1
  fi
  sed -i 's/g()/h()/' code.glsl
  ! bash "$script" --check page.md 2>/dev/null || { echo "a changed source was not found" >&2; exit 1; }
  for marker in 'gone.glsl from "a"' 'code.glsl from "int b"' 'code.glsl from "nothing"' 'code.glsl from "int a" to "nothing"'; do
    printf '<!-- excerpt: %s -->\n' "$marker" > page.md
    ! bash "$script" page.md 2>/dev/null || { echo "accepted: $marker" >&2; exit 1; }
  done
  exit 0
fi

check=""
if [ "${1-}" = --check ]; then check=1; shift; fi
pages=("$@")
if ((${#pages[@]} == 0)); then mapfile -t pages < <(grep -rlE '^<!-- excerpt: ' "$root/docs" --include='*.md' | sort); fi
status=0
for page in "${pages[@]}"; do
  text=$(fill "$page" && echo .) || { status=1; continue; }
  text=${text%.}
  if [ "$text" = "$(cat "$page")"$'\n' ]; then continue; fi
  if [ -n "$check" ]; then
    diff -u --label "$page" --label "current sources" "$page" <(printf '%s' "$text") >&2 || true
    echo "$page: an excerpt differs from its source; run: bash scripts/excerpts.sh" >&2
    status=1
  else
    printf '%s' "$text" > "$page"
  fi
done
exit "$status"
