// SPDX-License-Identifier: Apache-2.0
// Draws the linked pipeline as SVG. Boxes are buttons that open their source; boxes and arrows that a diagnostic names are
// marked, and those of the selected diagnostic stand out.
import { h, replace, svg } from "./dom";
import { layoutGraph } from "./layered_layout";
import { type GraphNode, hitObjectLegend, pipelineGraph } from "./pipeline_graph";
import type { PipelineModel } from "./pipeline_model";

const kLine = 16;
const kCharacter = 6.65; // width at 11 px, monospaced
const kPad = 9;
const kMaxCharacters = 44;
const kSmallest = 0.72; // zoom

export interface PipelineViewOptions {
  openSource: (node: GraphNode) => void;
  openDiagnostic: (index: number) => void;
}

const shorten = (text: string) => (text.length > kMaxCharacters ? `${text.slice(0, kMaxCharacters - 1)}…` : text);

export class PipelineView {
  readonly element = h("div", { class: "pipeline" });
  private model: PipelineModel | undefined;
  private selected: number | undefined;

  constructor(private readonly options: PipelineViewOptions) {
    new ResizeObserver(() => this.model && this.draw(this.model)).observe(this.element);
    this.show(undefined, "The diagram appears when the program compiles.");
  }

  // Without a model, `message` says why.
  show(model: PipelineModel | undefined, message = ""): void {
    this.model = model;
    this.selected = undefined;
    if (model) this.draw(model);
    else replace(this.element, h("p", { class: "empty" }, message));
  }

  // Index in PipelineModel.diagnostics.
  select(diagnostic: number | undefined): void {
    this.selected = diagnostic;
    if (this.model) this.draw(this.model);
  }

  get diagnostics() {
    return this.model?.diagnostics ?? [];
  }

  // Fits the panel, down to a size that is still readable. Text grows with that of the page.
  private zoomFor(width: number, height: number): number {
    const natural = parseFloat(getComputedStyle(document.documentElement).fontSize) / 13;
    const { clientWidth, clientHeight } = this.element;
    if (clientWidth === 0) return natural;
    const fit = Math.min((clientWidth - 24) / width, (clientHeight - 48) / height);
    return Math.min(natural, Math.max(fit, kSmallest * natural));
  }

  private draw(model: PipelineModel): void {
    const graph = pipelineGraph(model);
    const column = (node: GraphNode) => Math.max(0, ...node.rows.map(([label]) => label.length));
    const sizes = graph.nodes.map((node) => {
      const labels = column(node);
      const characters = Math.max(node.title.length + 1, ...node.rows.map(([, text]) => (labels ? labels + 2 : 0) + shorten(text).length));
      return { width: 2 * kPad + characters * kCharacter, height: 2 * kPad + kLine * (node.rows.length + 1) - 4 };
    });
    const layout = layoutGraph(sizes, graph.edges);
    const margin = 6;
    const marked = (diagnostics: readonly number[]) =>
      (diagnostics.length > 0 ? " reported" : "") + (this.selected !== undefined && diagnostics.includes(this.selected) ? " selected" : "");

    const arrows = graph.edges.map((edge, i) => {
      const points = layout.edges[i]!;
      const last = points[points.length - 1]!;
      let path = `M${points[0]!.x} ${points[0]!.y}`;
      for (let k = 1; k < points.length; ++k) {
        const a = points[k - 1]!;
        const b = points[k]!;
        const straight = points.length === 6 && a.x >= b.x - 22;
        const mid = (a.x + b.x) / 2;
        path += straight ? `L${b.x} ${b.y}` : `C${mid} ${a.y} ${mid} ${b.y} ${b.x} ${b.y}`;
      }
      const color = edge.ray === undefined ? "" : ` ray${edge.ray % 6}`;
      return svg(
        "g",
        { class: `arrow${color}${edge.exact ? "" : " inexact"}${marked(edge.diagnostics)}` },
        svg("path", { class: "line", d: path }),
        svg("path", { class: "head", d: `M${last.x} ${last.y}l-7 -3.5v7z` }),
      );
    });
    const boxes = graph.nodes.map((node, i) => {
      const at = layout.nodes[i]!;
      const size = sizes[i]!;
      const labels = column(node) ? (column(node) + 2) * kCharacter : 0;
      const problems = node.diagnostics.map((index) => model.diagnostics[index]).filter((diagnostic) => diagnostic !== undefined);
      const description = [node.title, ...node.rows.map(([label, text]) => `${label} ${text}`.trim()), ...problems.map((problem) => `${problem.id}: ${problem.text}`)].join(", ");
      const open = () => {
        if (node.diagnostics.length > 0) this.options.openDiagnostic(node.diagnostics[0]!);
        else this.options.openSource(node);
      };
      return svg(
        "g",
        {
          class: `node ${node.kind}${marked(node.diagnostics)}`,
          transform: `translate(${at.x} ${at.y})`,
          tabindex: 0,
          role: "button",
          "aria-label": description,
          onclick: open,
          onkeydown: (event: KeyboardEvent) => {
            if (event.key === "Enter" || event.key === " ") {
              event.preventDefault();
              open();
            }
          },
        },
        svg("title", {}, problems.length > 0 ? problems.map((problem) => `${problem.id}: ${problem.text}`).join("\n") : "Open the source"),
        svg("rect", { width: size.width, height: size.height, rx: node.kind === "trace" || node.kind === "call" ? 9 : 2 }),
        svg("text", { class: "title", x: kPad, y: kPad + 10 }, node.title),
        node.rows.map(([label, text], row) => [
          label !== "" && svg("text", { class: "label", x: kPad, y: kPad + 10 + kLine * (row + 1) }, label),
          svg("text", { x: kPad + labels, y: kPad + 10 + kLine * (row + 1) }, shorten(text), shorten(text) !== text && svg("title", {}, text)),
        ]),
        node.diagnostics.length > 0 && svg("text", { class: "badge", x: size.width - kPad, y: kPad + 10, "text-anchor": "end" }, "!"),
      );
    });
    const width = layout.width + 2 * margin;
    const height = layout.height + 2 * margin;
    const zoom = this.zoomFor(width, height);
    const facts = [
      `Recursion depth ${model.recursion.depth}`,
      model.recursion.declared !== null && `declared ${model.recursion.declared}`,
      `stack of at least ${model.recursion.stackBytes} bytes`,
      model.scene && `scene ${baseName(model.scene)}`,
    ].filter((fact): fact is string => typeof fact === "string");
    replace(
      this.element,
      h(
        "div",
        { class: "pipeline-facts" },
        h("span", {}, facts.join(" · ")),
        model.rays.length > 1 && h("span", { class: "legend" }, model.rays.map((ray, i) => h("span", { class: `ray${i % 6}` }, ray))),
        hitObjectLegend(model) !== "" && h("span", { class: "hit-objects" }, hitObjectLegend(model)),
        model.traces.some((trace) => trace.targets.some((target) => !target.exact)) && h("span", {}, "Dashed: may not be taken"),
      ),
      h(
        "div",
        { class: "pipeline-drawing" },
        svg(
          "svg",
          { width: width * zoom, height: height * zoom, viewBox: `${-margin} ${-margin} ${width} ${height}`, role: "group", "aria-label": "Linked pipeline" },
          arrows,
          boxes,
        ),
      ),
    );
    // A drawing that is larger than the panel shows the ray generation shader first, or what is selected.
    const target = this.element.querySelector(".selected") ?? this.element.querySelector(".node");
    const drawing = this.element.querySelector(".pipeline-drawing");
    if (!target || !drawing) return;
    const box = target.getBoundingClientRect();
    const frame = drawing.getBoundingClientRect();
    drawing.scrollTop += box.top + box.height / 2 - frame.top - frame.height / 2;
    if (this.selected !== undefined) drawing.scrollLeft += box.left + box.width / 2 - frame.left - frame.width / 2;
  }
}

function baseName(file: string): string {
  return file.replace(/^.*\//, "");
}
