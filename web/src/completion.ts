// SPDX-License-Identifier: Apache-2.0
// Completion and hover help of the GLSL editors.
import type { Completion, CompletionContext, CompletionResult } from "@codemirror/autocomplete";
import { hoverTooltip, type EditorView } from "@codemirror/view";
import type { Extension } from "@codemirror/state";
import { h } from "./dom";
import { type GlslContext, type Help, helpFor, libraryIncludes, membersOf, visibleNames } from "./glsl_help";
import { inlineMarkdown } from "./markdown";

const kTypes: Record<Help["kind"], string> = {
  function: "function", constant: "constant", macro: "function", struct: "class", variable: "variable", keyword: "keyword", type: "type", parameter: "property", builtin: "builtin",
};
// Names of the program come first, GLSL words last.
const kBoost: Partial<Record<Help["kind"], number>> = { parameter: 20, builtin: 5, keyword: -10, type: -5 };

function helpElement(help: Help): HTMLElement {
  return h(
    "div",
    { class: "code-help" },
    h("pre", {}, help.signature),
    help.text && h("p", {}, inlineMarkdown(help.text)),
    h("p", { class: "origin" }, help.origin),
    help.wrongStage && h("p", { class: "wrong" }, "Not available in this stage"),
  );
}

// The line after the last #include or #extension, for a header that is not included yet.
function includeChange(view: EditorView, context: GlslContext, header: string): { from: number; insert: string } | undefined {
  if (context.form !== "folder" || context.source.includes(`<${header}>`)) return undefined;
  let line = 0;
  for (let i = 1; i <= view.state.doc.lines; ++i) if (/^\s*#\s*(include|extension|version|define)\b/.test(view.state.doc.line(i).text)) line = i;
  return { from: line === 0 ? 0 : view.state.doc.line(line).to, insert: line === 0 ? `#include <${header}>\n` : `\n#include <${header}>` };
}

function asCompletion(help: Help, context: GlslContext): Completion {
  const called = help.kind === "function" && help.signature.includes("(");
  return {
    label: help.name,
    type: kTypes[help.kind],
    boost: kBoost[help.kind] ?? (help.origin === "this program" ? 15 : 0),
    detail: help.include ? help.include.replace(/^quintet\//, "") : "",
    info: help.signature === help.name && !help.text ? undefined : () => helpElement(help),
    apply: (view, _completion, from, to) => {
      const next = view.state.sliceDoc(to, to + 1);
      const insert = help.name + (called && next !== "(" ? "(" : "");
      const include = help.include ? includeChange(view, context, help.include) : undefined;
      const shift = include && include.from <= from ? include.insert.length : 0;
      view.dispatch({
        changes: include ? [include, { from, to, insert }] : { from, to, insert },
        selection: { anchor: from + insert.length + shift },
        userEvent: "input.complete",
      });
    },
  };
}

export function glslCompletions(current: () => GlslContext): (context: CompletionContext) => CompletionResult | null {
  return (at) => {
    const line = at.state.doc.lineAt(at.pos);
    const before = line.text.slice(0, at.pos - line.from);
    if (/\/\//.test(before)) return null;
    const include = /#\s*include\s*<([\w./]*)$/.exec(before);
    if (include) {
      const options = libraryIncludes.map((file) => ({ label: `quintet/${file}`, type: "text", apply: `quintet/${file}>` }));
      return { from: at.pos - include[1]!.length, options, validFor: /^[\w./]*$/ };
    }
    const context = current();
    const member = /([A-Za-z_]\w*)\s*(?:\[[^\]]*\])?\s*\.\s*(\w*)$/.exec(before);
    if (member) {
      const options = membersOf(member[1]!, context).map(({ name, signature }) => ({ label: name, type: "property", detail: signature }));
      return options.length > 0 ? { from: at.pos - member[2]!.length, options, validFor: /^\w*$/ } : null;
    }
    const word = /[A-Za-z_]\w*$/.exec(before);
    if (!word && !at.explicit) return null;
    if (word && word[0].length < 2 && !at.explicit) return null;
    return {
      from: at.pos - (word?.[0].length ?? 0),
      options: visibleNames(context).map((help) => asCompletion(help, context)),
      validFor: /^\w*$/,
    };
  };
}

export function glslHover(current: () => GlslContext): Extension {
  return hoverTooltip(
    (view, position) => {
      const line = view.state.doc.lineAt(position);
      const offset = position - line.from;
      const comment = line.text.indexOf("//");
      if (comment >= 0 && offset > comment) return null;
      for (const match of line.text.matchAll(/[A-Za-z_]\w*/g)) {
        if (match.index > offset || match.index + match[0].length < offset) continue;
        const help = helpFor(match[0], current());
        if (!help || help.kind === "keyword" || help.kind === "type") return null;
        return { pos: line.from + match.index, end: line.from + match.index + match[0].length, above: true, create: () => ({ dom: helpElement(help) }) };
      }
      return null;
    },
    { hoverTime: 350 },
  );
}
