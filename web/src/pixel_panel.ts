// SPDX-License-Identifier: Apache-2.0
// The pixel explorer: the value of a pixel, the surface that is visible there, the tree of its rays with payloads and source
// lines, and what the program prints for it.
import { h, replace } from "./dom";
import type { Picked, PrintedLine } from "./protocol";
import { type Explanation, formatValue, rayTree, type TreeRow } from "./ray_tree";
import { type TreeItem, TreeView } from "./tree_view";

export interface PixelHost {
  explain: (x: number, y: number, sample: number) => void;
  openSource: (file: string, line: number) => void;
  hasSource: (file: string) => boolean;
  print: (on: boolean) => void;
}

export interface PixelFacts {
  x: number;
  y: number;
  value?: readonly (number | string)[];
  displayed?: readonly number[];
  picked?: Picked;
}

// A swatch of a linear color.
function swatch(color: readonly number[]): HTMLElement {
  const encode = (value: number) => Math.round(255 * Math.min(1, Math.max(0, value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055)));
  const element = h("span", { class: "swatch", "aria-hidden": "true" });
  element.style.backgroundColor = `rgb(${color.map(encode).join(",")})`;
  return element;
}

export class PixelPanel {
  readonly element = h("div", { class: "pixel" });
  private readonly facts = h("dl", { class: "pixel-facts" });
  private readonly message = h("p", { class: "empty", role: "status" });
  private readonly tree = new TreeView("Rays of the sample");
  private readonly printed = h("div", { class: "printed" });
  private readonly sample = h("input", { type: "number", class: "number", min: 0, step: 1, value: "0", "aria-label": "Sample" });
  private readonly sampleLabel = h("label", {}, "Sample ", this.sample);
  private readonly controls = h("div", { class: "pixel-controls", hidden: true });
  private at: { x: number; y: number } | undefined;
  private readonly printBox = h("input", { type: "checkbox" });
  private readonly printLabel = h("label", { title: "Show what debugPrintfEXT prints for this pixel" }, this.printBox, " Print");

  constructor(private readonly host: PixelHost) {
    this.sample.addEventListener("change", () => {
      if (this.at && this.sample.checkValidity()) host.explain(this.at.x, this.at.y, this.sample.valueAsNumber);
    });
    this.printBox.addEventListener("change", () => host.print(this.printBox.checked));
    replace(this.controls, this.sampleLabel, this.printLabel);
    replace(this.element, this.controls, this.facts, this.message, this.tree.element, this.printed);
    this.clear();
  }

  clear(): void {
    this.at = undefined;
    this.controls.hidden = true;
    replace(this.facts);
    this.tree.show([]);
    replace(this.printed);
    this.say("Click a pixel of the image: its rays, the payloads and the source lines appear here.");
  }

  say(text: string): void {
    this.message.hidden = text === "";
    this.message.textContent = text;
  }

  get sampleNumber(): number {
    return this.sample.checkValidity() ? this.sample.valueAsNumber : 0;
  }

  set sampleNumber(sample: number) {
    this.sample.value = String(sample);
  }

  get printing(): boolean {
    return this.printBox.checked;
  }

  setSession(frames: boolean, prints: boolean): void {
    this.sampleLabel.firstChild!.textContent = frames ? "Frame " : "Sample ";
    this.sample.setAttribute("aria-label", frames ? "Frame" : "Sample");
    this.printLabel.hidden = !prints;
  }

  showFacts(facts: PixelFacts): void {
    this.at = facts;
    this.controls.hidden = false;
    const rows: [string, (Node | string)[]][] = [["Pixel", [`${facts.x}, ${facts.y}`]]];
    if (facts.value) {
      const numbers = facts.value.filter((value): value is number => typeof value === "number");
      rows.push(["Value", [...(numbers.length >= 3 ? [swatch(numbers.slice(0, 3)), " "] : []), facts.value.map(formatValue).join(" ")]]);
    }
    if (facts.displayed) rows.push(["Displayed", [facts.displayed.join(" ")]]);
    const picked = facts.picked;
    if (picked && picked.instance !== null) {
      rows.push(["Surface", [`${picked.instance}${picked.material ? `, ${picked.material}` : ""}, primitive ${picked.primitive ?? 0}${picked.front === false ? ", back side" : ""}`]]);
      if (picked.distance !== undefined) rows.push(["Depth", [`${formatValue(picked.distance)} m`]]);
      if (picked.position) rows.push(["Position", [formatValue(picked.position)]]);
      if (picked.normal) rows.push(["Normal", [formatValue(picked.normal)]]);
    } else if (picked) rows.push(["Surface", ["none"]]);
    replace(this.facts, rows.map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, value))));
  }

  showExplanation(explanation: Explanation): void {
    this.say(explanation.discarded ? "The program discarded this sample, because it is not finite." : "");
    if (explanation.lostRecords) this.say(`${explanation.lostRecords} records did not fit into the log.`);
    const outputs = explanation.outputs.map((output) => this.output(output.name, output.value));
    const origin = explanation.origin;
    if (origin)
      outputs.unshift(
        this.item({
          kind: "origin",
          title: "First value that is not finite",
          facts: [["operation", origin.operation], ["result", origin.nan ? "NaN" : "infinite"]],
          file: origin.file,
          line: origin.line,
          children: [],
        }),
      );
    const contributions = explanation.contributions.map((contribution) =>
      this.item({
        kind: "contribution",
        title: `${contribution.source}${contribution.ray !== undefined ? `, after ray ${contribution.ray}` : ""}`,
        facts: [["value", formatValue(contribution.value)]],
        file: "",
        line: 0,
        children: [],
        ...(Array.isArray(contribution.value) && { color: contribution.value.slice(0, 3) as [number, number, number] }),
      }),
    );
    const rays = rayTree(explanation).map((row) => this.item(row, 0));
    this.tree.show([
      ...outputs,
      ...(contributions.length > 1 ? [{ head: [document.createTextNode(`${contributions.length} contributions`)], detail: undefined, children: contributions, open: false }] : []),
      ...rays,
    ]);
  }

  showPrinted(lines: readonly PrintedLine[], omitted: number): void {
    replace(
      this.printed,
      lines.length > 0 && h("h3", {}, "Printed"),
      h(
        "ul",
        {},
        lines.map((line) =>
          h(
            "li",
            {},
            h("button", { type: "button", class: "link location", onclick: () => this.host.openSource(line.file, line.line) }, `${line.file.replace(/^.*\//, "")}:${line.line}`),
            " ",
            h("code", {}, line.text),
          ),
        ),
      ),
      omitted > 0 && h("p", {}, `${omitted} further lines`),
    );
  }

  private output(name: string, value: unknown): TreeItem {
    const color = Array.isArray(value) && value.length >= 3 && value.slice(0, 3).every((component) => typeof component === "number") ? (value.slice(0, 3) as number[]) : undefined;
    return {
      head: [h("span", { class: "event store" }, ...(color ? [swatch(color), " "] : []), h("b", {}, name), ` ${formatValue(value)}`)],
      detail: undefined,
      children: [],
      open: false,
    };
  }

  private item(row: TreeRow, depth = 0): TreeItem {
    const hasSource = row.file !== "" && row.line > 0 && this.host.hasSource(row.file);
    const place = row.file && row.line > 0 ? `${row.file.replace(/^.*\//, "")}:${row.line}` : "";
    const head: Node[] = [
      h("span", { class: `event ${row.kind}` }, ...(row.color ? [swatch(row.color), " "] : []), row.title),
      ...(place
        ? [
            hasSource
              ? h(
                  "button",
                  {
                    type: "button",
                    class: "link location",
                    tabindex: -1,
                    onclick: (event: Event) => {
                      event.stopPropagation();
                      this.host.openSource(row.file, row.line);
                    },
                  },
                  place,
                )
              : h("span", { class: "location" }, place),
          ]
        : []),
    ];
    return {
      head,
      detail: row.facts.length > 0 ? h("dl", {}, row.facts.map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, value)))) : undefined,
      children: row.children.map((child) => this.item(child, depth + 1)),
      open: depth < 3,
      ...(hasSource && { activate: () => this.host.openSource(row.file, row.line) }),
    };
  }
}
