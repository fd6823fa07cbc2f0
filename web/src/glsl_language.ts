// SPDX-License-Identifier: Apache-2.0
// GLSL for the editor: highlighting, indentation and comments. A tokenizer by lines, because the editors show parts of
// files that a grammar of whole files would reject.
import { HighlightStyle, StreamLanguage, type StreamParser, type StringStream, syntaxHighlighting } from "@codemirror/language";
import { tags } from "@lezer/highlight";
import { kAtoms, kFunctions, kKeywords, kRayBuiltIns, kRayConstants, kTypes } from "./glsl_words";

interface State {
  inComment: boolean;
  depth: number; // of (, [ and {
  blocks: number[]; // indentation of the lines that opened them
  lineIndent: number;
  continued: boolean; // the line before has no end of a statement
}

function word(stream: StringStream, text: string): string {
  if (kKeywords.has(text)) return "keyword";
  if (kTypes.has(text)) return "typeName";
  if (kAtoms.has(text)) return "atom";
  if (text.startsWith("gl_") || kRayBuiltIns.has(text) || kRayConstants.has(text)) return "builtin";
  if (text.startsWith("gsn")) return "builtin";
  const called = /^\s*\(/.test(stream.string.slice(stream.pos));
  if (called) return kFunctions.has(text) ? "builtin" : "function";
  if (/^[A-Z]\w*[a-z]/.test(text)) return "typeName";
  return "variableName";
}

const parser: StreamParser<State> = {
  name: "glsl",
  startState: () => ({ inComment: false, depth: 0, blocks: [], lineIndent: 0, continued: false }),
  copyState: (state) => ({ ...state, blocks: [...state.blocks] }),
  token(stream, state) {
    if (stream.sol()) state.lineIndent = stream.indentation();
    if (state.inComment) {
      if (stream.skipTo("*/")) {
        stream.match("*/");
        state.inComment = false;
      } else stream.skipToEnd();
      return "comment";
    }
    if (stream.eatSpace()) return null;
    if (stream.match("//")) {
      stream.skipToEnd();
      return "comment";
    }
    if (stream.match("/*")) {
      state.inComment = true;
      return "comment";
    }
    if (/^\s*$/.test(stream.string.slice(0, stream.pos)) && stream.peek() === "#") {
      if (stream.match(/^#\s*include\b/)) return "processingInstruction";
      stream.match(/^#\s*\w*/);
      return "processingInstruction";
    }
    if (/^\s*#\s*include\s*$/.test(stream.string.slice(0, stream.pos)) && stream.match(/^(<[^>]*>|"[^"]*")/)) return "string";
    if (stream.match(/^"([^"\\]|\\.)*"?/)) return "string";
    if (stream.match(/^(0[xX][0-9a-fA-F]+[uU]?|(\d+\.\d*|\.\d+|\d+)([eE][+-]?\d+)?([fF]|lf|LF|[uU]|ul|UL)?)/)) {
      state.continued = true;
      return "number";
    }
    const name = stream.match(/^[A-Za-z_]\w*/) as RegExpMatchArray | null;
    if (name) {
      state.continued = true;
      const afterDot = /\.\s*$/.test(stream.string.slice(0, stream.pos - name[0].length));
      return afterDot ? "propertyName" : word(stream, name[0]);
    }
    const character = stream.next()!;
    if ("{[(".includes(character)) {
      state.blocks.push(state.lineIndent);
      state.continued = false;
      return "bracket";
    }
    if ("}])".includes(character)) {
      state.blocks.pop();
      state.continued = character === ")";
      return "bracket";
    }
    if (character === ";" || character === ",") {
      state.continued = false;
      return "punctuation";
    }
    stream.eatWhile(/[+\-*/%=<>!&|^~?:]/);
    state.continued = true;
    return "operator";
  },
  indent(state, textAfter, context) {
    if (state.inComment) return null;
    if (/^\s*#/.test(textAfter)) return 0;
    const open = state.blocks[state.blocks.length - 1];
    if (open === undefined) return 0;
    return /^\s*[}\])]/.test(textAfter) ? open : open + context.unit;
  },
  languageData: {
    commentTokens: { line: "//", block: { open: "/*", close: "*/" } },
    closeBrackets: { brackets: ["(", "[", "{", '"'] },
    indentOnInput: /^\s*[}\])]$/,
  },
  tokenTable: {
    builtin: tags.standard(tags.variableName),
    function: tags.function(tags.variableName),
  },
};

export const glslLanguage = StreamLanguage.define(parser);

// Colors are custom properties of the page, so that themes need no second style.
export const labHighlighting = syntaxHighlighting(
  HighlightStyle.define([
    { tag: tags.comment, color: "var(--code-comment)" },
    { tag: [tags.keyword, tags.processingInstruction], color: "var(--code-keyword)" },
    { tag: tags.typeName, color: "var(--code-type)" },
    { tag: [tags.number, tags.atom, tags.bool], color: "var(--code-number)" },
    { tag: tags.string, color: "var(--code-string)" },
    { tag: tags.standard(tags.variableName), color: "var(--code-builtin)" },
    { tag: tags.function(tags.variableName), color: "var(--code-function)" },
    { tag: tags.propertyName, color: "var(--code-property)" },
    { tag: [tags.operator, tags.punctuation, tags.bracket], color: "var(--code-operator)" },
    { tag: tags.heading, color: "var(--code-keyword)", fontWeight: "600" },
  ]),
);
