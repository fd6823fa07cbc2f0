// SPDX-License-Identifier: Apache-2.0
// The list of problems of the program: location, text, reason and fix, with a button for the explanation.
import { type Diagnostic, hasPage, isRunFinding, pixelOf } from "./diagnostic";
import { h, replace } from "./dom";

export interface ProblemsHost {
  open: (file: string, line: number, column: number) => void;
  explain: (id: string) => void;
  inDiagram: (diagnostic: Diagnostic) => void;
  showPixel: (x: number, y: number) => void;
}

const kOrder = { error: 0, warning: 1, note: 2 };

export function locationText(file: string, line: number, column: number): string {
  const name = file.replace(/^.*\//, "");
  return name + (line > 0 ? `:${line}` : "") + (line > 0 && column > 0 ? `:${column}` : "");
}

export class ProblemsPanel {
  readonly element = h("div", { class: "problems" });

  constructor(private readonly host: ProblemsHost) {}

  show(diagnostics: readonly Diagnostic[], checked: boolean): void {
    if (diagnostics.length === 0) {
      replace(this.element, h("p", { class: "empty" }, checked ? "The shaders compile, and the linked pipeline passes the check." : "The program was not checked yet."));
      return;
    }
    const sorted = [...diagnostics].sort((a, b) => kOrder[a.severity] - kOrder[b.severity]);
    replace(this.element, h("ul", { "aria-label": "Problems" }, sorted.map((diagnostic) => this.row(diagnostic))));
  }

  private location(file: string, line: number, column: number): HTMLElement | false {
    if (!file) return false;
    return h("button", { type: "button", class: "link location", title: file, onclick: () => this.host.open(file, line, column) }, locationText(file, line, column));
  }

  private row(diagnostic: Diagnostic): HTMLElement {
    const pixel = pixelOf(diagnostic);
    return h(
      "li",
      { class: `problem ${diagnostic.severity}` },
      h("span", { class: "severity" }, diagnostic.severity),
      h(
        "div",
        { class: "problem-text" },
        h(
          "p",
          {},
          this.location(diagnostic.file, diagnostic.line, diagnostic.column),
          " ",
          diagnostic.text,
        ),
        (diagnostic.related ?? []).map((related) => h("p", { class: "related" }, this.location(related.file, related.line, related.column), " ", related.text)),
        diagnostic.why && h("p", { class: "reason" }, h("b", {}, "Why: "), diagnostic.why),
        diagnostic.fix && h("p", { class: "reason" }, h("b", {}, "Fix: "), diagnostic.fix),
      ),
      h(
        "div",
        { class: "problem-actions" },
        hasPage(diagnostic.id) ? h("button", { type: "button", class: "small", onclick: () => this.host.explain(diagnostic.id) }, `Explain ${diagnostic.id}`) : h("span", { class: "id" }, diagnostic.id),
        pixel && h("button", { type: "button", class: "small", title: "Show the rays of the first pixel", onclick: () => this.host.showPixel(pixel.x, pixel.y) }, "Pixel"),
        hasPage(diagnostic.id) && !isRunFinding(diagnostic) && h("button", { type: "button", class: "small", title: "Show it in the pipeline diagram", onclick: () => this.host.inDiagram(diagnostic) }, "Diagram"),
      ),
    );
  }
}
