// SPDX-License-Identifier: Apache-2.0
// The editor that all tabs share: keys, history, search, folding of brackets, completion, appearance.
import { autocompletion, closeBrackets, closeBracketsKeymap, type CompletionSource, completionKeymap } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { bracketMatching, indentOnInput, indentRange, indentUnit, StreamLanguage } from "@codemirror/language";
import { lintGutter, lintKeymap, nextDiagnostic } from "@codemirror/lint";
import { toml } from "@codemirror/legacy-modes/mode/toml";
import { highlightSelectionMatches, search, searchKeymap } from "@codemirror/search";
import { type Extension, Prec } from "@codemirror/state";
import { drawSelection, EditorView, highlightActiveLine, highlightActiveLineGutter, highlightSpecialChars, keymap } from "@codemirror/view";
import { glslHover } from "./completion";
import { glslLanguage, labHighlighting } from "./glsl_language";
import type { GlslContext } from "./glsl_help";

const kAppearance = EditorView.theme({
  "&": { height: "100%", fontSize: "var(--code-size)", backgroundColor: "var(--editor)", color: "var(--text)" },
  "&.cm-focused": { outline: "none" },
  ".cm-scroller": { fontFamily: "var(--mono)", lineHeight: "1.5", overflow: "auto" },
  ".cm-content": { caretColor: "var(--text)", padding: "6px 0" },
  ".cm-cursor": { borderLeftColor: "var(--text)", borderLeftWidth: "2px" },
  ".cm-gutters": { backgroundColor: "var(--editor)", color: "var(--text-faint)", border: "none", paddingLeft: "4px" },
  ".cm-activeLineGutter": { backgroundColor: "var(--active-line)", color: "var(--text-soft)" },
  ".cm-activeLine": { backgroundColor: "var(--active-line)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground, .cm-content ::selection": { backgroundColor: "var(--selection)" },
  ".cm-selectionMatch": { backgroundColor: "var(--match)" },
  "&.cm-focused .cm-matchingBracket": { backgroundColor: "var(--match)", outline: "1px solid var(--line-strong)" },
  ".cm-searchMatch": { backgroundColor: "var(--match)", outline: "1px solid var(--line-strong)" },
  ".cm-searchMatch.cm-searchMatch-selected": { backgroundColor: "var(--selection)" },
  ".cm-panels": { backgroundColor: "var(--panel)", color: "var(--text)", fontFamily: "var(--sans)" },
  ".cm-panels.cm-panels-top": { borderBottom: "1px solid var(--line)" },
  ".cm-panels.cm-panels-bottom": { borderTop: "1px solid var(--line)" },
  ".cm-panel.cm-search": { padding: "6px 28px 6px 8px", fontSize: "12px" },
  ".cm-panel.cm-search label": { fontSize: "12px", marginRight: "8px" },
  ".cm-panel.cm-search [name=close]": { color: "var(--text-soft)", fontSize: "16px", padding: "2px 8px" },
  ".cm-textfield": { backgroundColor: "var(--editor)", border: "1px solid var(--line-strong)", color: "var(--text)", fontSize: "12px", borderRadius: "3px" },
  ".cm-button": { backgroundImage: "none", backgroundColor: "var(--control)", border: "1px solid var(--line-strong)", color: "var(--text)", fontSize: "12px", borderRadius: "3px" },
  ".cm-tooltip": { backgroundColor: "var(--raised)", color: "var(--text)", border: "1px solid var(--line-strong)", borderRadius: "4px", boxShadow: "var(--shadow)" },
  ".cm-tooltip.cm-tooltip-autocomplete > ul": { fontFamily: "var(--mono)", fontSize: "12px", maxHeight: "16em" },
  ".cm-tooltip.cm-tooltip-autocomplete > ul > li": { padding: "2px 8px" },
  ".cm-tooltip-autocomplete ul li[aria-selected]": { backgroundColor: "var(--accent)", color: "var(--on-accent)" },
  ".cm-completionDetail": { color: "inherit", opacity: "0.65", fontStyle: "normal" },
  ".cm-completionIcon": { width: "1.2em", opacity: "0.7" },
  ".cm-tooltip.cm-completionInfo": { padding: "0", maxWidth: "min(440px, 60vw)" },
  ".cm-diagnostic": { padding: "6px 10px", borderLeft: "none", maxWidth: "520px" },
  ".cm-gutter-lint": { width: "14px" },
  ".cm-gutter-lint .cm-gutterElement": { padding: "0" },
  ".cm-lint-marker": { width: "8px", height: "8px", margin: "6px 3px", borderRadius: "50%", content: "none" },
  ".cm-lint-marker-error": { backgroundColor: "var(--error)" },
  ".cm-lint-marker-warning": { backgroundColor: "var(--warning)" },
  ".cm-lint-marker-info, .cm-lint-marker-hint": { backgroundColor: "var(--text-faint)" },
  ".cm-lintRange": { backgroundImage: "none", paddingBottom: "0" },
  ".cm-lintRange-error": { textDecoration: "underline wavy var(--error) 1px", textUnderlineOffset: "3px" },
  ".cm-lintRange-warning": { textDecoration: "underline wavy var(--warning) 1px", textUnderlineOffset: "3px" },
  ".cm-lintRange-info, .cm-lintRange-hint": { textDecoration: "underline dotted var(--text-soft) 1px", textUnderlineOffset: "3px" },
  ".cm-lintRange-active": { backgroundColor: "var(--match)" },
  ".cm-flash": { backgroundColor: "var(--match)" },
});

export function styleNonce(): string {
  return document.querySelector<HTMLMetaElement>("meta[name=csp-nonce]")?.content ?? "";
}

// Indents all lines and removes spaces at their ends.
export function indentDocument(view: EditorView): void {
  view.dispatch({ changes: indentRange(view.state, 0, view.state.doc.length), userEvent: "format" });
  const changes = [];
  for (let i = 1; i <= view.state.doc.lines; ++i) {
    const line = view.state.doc.line(i);
    const kept = line.text.trimEnd().length;
    if (kept < line.length) changes.push({ from: line.from + kept, to: line.to });
  }
  if (changes.length > 0) view.dispatch({ changes, userEvent: "format" });
}

const tomlLanguage = StreamLanguage.define(toml);

export type SourceLanguage = "glsl" | "toml" | "text";

export interface EditorOptions {
  language: SourceLanguage;
  label: string;
  context: () => GlslContext;
  completions?: CompletionSource;
  save: () => void;
  format: (view: EditorView) => void;
  extra: Extension;
}

export function editorExtensions(options: EditorOptions): Extension {
  const glsl = options.language === "glsl";
  return [
    EditorView.cspNonce.of(styleNonce()),
    highlightSpecialChars(),
    history(),
    drawSelection(),
    indentOnInput(),
    bracketMatching(),
    closeBrackets(),
    highlightActiveLine(),
    highlightActiveLineGutter(),
    highlightSelectionMatches(),
    search({ top: true }),
    lintGutter(),
    indentUnit.of("  "),
    labHighlighting,
    glsl ? [glslLanguage, glslHover(options.context)] : options.language === "toml" ? tomlLanguage : [],
    autocompletion(options.completions ? { override: [options.completions], icons: true } : {}),
    // Tab moves the focus after Escape, so that the keyboard can leave the editor.
    Prec.high(
      keymap.of([
        { key: "Mod-s", preventDefault: true, run: () => (options.save(), true) },
        { key: "Shift-Alt-f", run: (view) => (options.format(view), true), preventDefault: true },
        { key: "F8", run: nextDiagnostic },
      ]),
    ),
    keymap.of([...closeBracketsKeymap, ...defaultKeymap, ...searchKeymap, ...historyKeymap, ...completionKeymap, ...lintKeymap, indentWithTab]),
    EditorView.contentAttributes.of({ "aria-label": options.label, spellcheck: "false", autocorrect: "off", autocapitalize: "off" }),
    kAppearance,
    options.extra,
  ];
}
