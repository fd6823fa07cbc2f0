// SPDX-License-Identifier: Apache-2.0
// The parameters of the program as controls that follow from their declarations: sliders, numbers, colors, choices, files.
import { fromHex, toHex } from "./color";
import { h, replace, uniqueId } from "./dom";
import { icon } from "./icons";
import type { ParameterDescription, ParameterValue } from "./protocol";

export interface ParametersHost {
  set: (name: string, value: ParameterValue) => void;
  // Ends a series of values of a slider, so that it is one step of undo.
  end: () => void;
  // Uploads an image next to the program and returns its name; undefined if it failed.
  upload: (file: File) => Promise<string | undefined>;
  images: () => readonly string[]; // image files of the program
}

export function sameValue(a: ParameterValue | undefined, b: ParameterValue | undefined): boolean {
  if (Array.isArray(a) && Array.isArray(b)) return a.length === b.length && a.every((value, i) => sameValue(value, b[i]));
  if (typeof a === "number" && typeof b === "number") return Math.abs(a - b) <= 1e-6 * Math.max(1, Math.abs(a), Math.abs(b));
  return a === b;
}

// The interval of a slider: the declared one, or one around the default that the number field can leave.
export function sliderRange(parameter: ParameterDescription, value: number): { min: number; max: number; step: number } {
  const whole = parameter.type === "int" || parameter.type === "uint";
  const base = typeof parameter.default === "number" ? parameter.default : Array.isArray(parameter.default) ? Math.max(...parameter.default.map(Math.abs)) : 1;
  const reach = Math.max(1, 2 * Math.abs(base), Math.abs(value));
  let min = parameter.min ?? (base < 0 || value < 0 || parameter.type.startsWith("vec") ? -reach : 0);
  let max = parameter.max ?? Math.max(min + 1, reach);
  // Huge limits make a slider useless.
  if (max - min > 1e5) max = Math.max(min + 1, reach);
  if (max - min > 1e5) min = max - 2 * reach;
  const range = max - min;
  const step = whole ? 1 : 10 ** Math.floor(Math.log10(range / 200));
  return { min, max, step };
}

interface Control {
  element: HTMLElement;
  update: (value: ParameterValue) => void;
}

export class ParametersPanel {
  readonly element = h("div", { class: "parameters" });
  private controls = new Map<string, { control: Control; row: HTMLElement; parameter: ParameterDescription }>();
  private shown = "";

  constructor(private readonly host: ParametersHost) {}

  // Until the program is open.
  clear(): void {
    this.shown = "";
    this.controls.clear();
    replace(this.element, h("p", { class: "empty" }, "The parameters appear when the program compiles."));
  }

  // `linear`: colors of the program are linear.
  show(parameters: readonly ParameterDescription[], values: Readonly<Record<string, ParameterValue>>, linear: boolean): void {
    const key = JSON.stringify([parameters, linear]);
    if (key !== this.shown) {
      this.shown = key;
      this.build(parameters, values, linear);
    }
    for (const [name, { control, row, parameter }] of this.controls) {
      const value = values[name] ?? parameter.default;
      row.classList.toggle("changed", !sameValue(value, parameter.default));
      // What the user edits now is not replaced by an older value.
      if (!row.contains(document.activeElement) || document.activeElement instanceof HTMLButtonElement) control.update(value);
    }
  }

  private build(parameters: readonly ParameterDescription[], values: Readonly<Record<string, ParameterValue>>, linear: boolean): void {
    this.controls.clear();
    if (parameters.length === 0) {
      replace(
        this.element,
        h("p", { class: "empty" }, "The program has no parameters. In a lecture file, ", h("code", {}, "uniform float size; // defaultval=\"1\""), " declares one; in a folder, a table ", h("code", {}, "[[parameter]]"), " of program.toml."),
      );
      return;
    }
    const resetAll = h("button", { type: "button", class: "small", onclick: () => parameters.forEach((parameter) => this.reset(parameter)) }, "Reset all");
    replace(
      this.element,
      parameters.map((parameter) => {
        const id = uniqueId("parameter");
        const control = this.control(parameter, values[parameter.name] ?? parameter.default, id, linear);
        const reset = h("button", { type: "button", class: "icon reset", title: "Reset to the default", "aria-label": `Reset ${parameter.name}`, onclick: () => this.reset(parameter) }, icon("reset"));
        const row = h(
          "div",
          { class: `parameter ${parameter.type}`, dataset: { parameter: parameter.name } },
          h("label", { for: id, title: parameter.help || undefined }, parameter.name, parameter.unit && h("span", { class: "unit" }, parameter.unit)),
          control.element,
          reset,
        );
        this.controls.set(parameter.name, { control, row, parameter });
        return row;
      }),
      h("div", { class: "parameter-actions" }, resetAll),
    );
  }

  private reset(parameter: ParameterDescription): void {
    this.host.set(parameter.name, parameter.default);
    this.host.end();
    this.controls.get(parameter.name)?.control.update(parameter.default);
  }

  private control(parameter: ParameterDescription, value: ParameterValue, id: string, linear: boolean): Control {
    switch (parameter.type) {
      case "bool":
        return this.flag(parameter, value, id);
      case "choice":
        return this.choice(parameter, value, id);
      case "image":
        return this.image(parameter, value, id);
      case "color":
        return this.color(parameter, value, id, linear);
      case "vec2":
      case "vec3":
      case "vec4":
        return this.vector(parameter, value, id);
      default:
        return this.number(parameter, value, id);
    }
  }

  private flag(parameter: ParameterDescription, value: ParameterValue, id: string): Control {
    const input = h("input", { id, type: "checkbox", checked: value === true });
    input.addEventListener("change", () => this.host.set(parameter.name, input.checked));
    return { element: h("div", { class: "control" }, input), update: (next) => (input.checked = next === true) };
  }

  private choice(parameter: ParameterDescription, value: ParameterValue, id: string): Control {
    const select = h("select", { id }, (parameter.choices ?? []).map((choice) => h("option", { value: choice, selected: choice === value }, choice)));
    select.addEventListener("change", () => this.host.set(parameter.name, select.value));
    return { element: h("div", { class: "control" }, select), update: (next) => (select.value = String(next)) };
  }

  private image(parameter: ParameterDescription, value: ParameterValue, id: string): Control {
    let current = String(value);
    const select = h("select", { id });
    const fill = () => {
      const names = [...new Set([...this.host.images(), ...(current ? [current] : [])])].sort();
      replace(select, h("option", { value: "" }, "none (white)"), names.map((name) => h("option", { value: name }, name.replace(/^.*\//, ""))));
      select.value = current;
    };
    fill();
    select.addEventListener("focus", fill);
    select.addEventListener("change", () => this.host.set(parameter.name, (current = select.value)));
    const file = h("input", { type: "file", accept: ".png,.jpg,.jpeg,.webp,.ktx2,.hdr,.exr", hidden: true, "aria-label": `File for ${parameter.name}` });
    file.addEventListener("change", async () => {
      const chosen = file.files?.[0];
      const name = chosen && (await this.host.upload(chosen));
      if (!name) return;
      current = name;
      fill();
      this.host.set(parameter.name, name);
    });
    const pick = h("button", { type: "button", class: "small", onclick: () => file.click() }, "File…");
    return {
      element: h("div", { class: "control" }, select, pick, file),
      update: (next) => {
        current = String(next);
        fill();
      },
    };
  }

  private numberField(parameter: ParameterDescription, value: number, label: string, change: (value: number) => void): HTMLInputElement {
    const whole = parameter.type === "int" || parameter.type === "uint";
    const input = h("input", { type: "number", class: "number", value: String(value), min: parameter.min ?? undefined, max: parameter.max ?? undefined, step: whole ? 1 : "any", "aria-label": label });
    input.addEventListener("input", () => {
      if (input.value !== "" && input.checkValidity()) change(input.valueAsNumber);
    });
    input.addEventListener("change", () => {
      if (!input.checkValidity()) input.reportValidity();
      this.host.end();
    });
    return input;
  }

  private number(parameter: ParameterDescription, value: ParameterValue, id: string): Control {
    const range = sliderRange(parameter, Number(value));
    const slider = h("input", { id, type: "range", min: range.min, max: range.max, step: range.step, value: String(value) });
    const field = this.numberField(parameter, Number(value), `${parameter.name}, number`, (next) => {
      slider.value = String(next);
      this.host.set(parameter.name, next);
    });
    slider.addEventListener("input", () => {
      field.value = slider.value;
      this.host.set(parameter.name, slider.valueAsNumber);
    });
    slider.addEventListener("change", () => this.host.end());
    return {
      element: h("div", { class: "control" }, slider, field),
      update: (next) => {
        slider.value = String(next);
        field.value = String(Number(Number(next).toPrecision(6)));
      },
    };
  }

  private vector(parameter: ParameterDescription, value: ParameterValue, id: string): Control {
    let current = [...(value as number[])];
    const fields = current.map((component, i) =>
      this.numberField(parameter, component, `${parameter.name} ${"xyzw"[i]}`, (next) => {
        current = current.map((old, k) => (k === i ? next : old));
        this.host.set(parameter.name, current);
      }),
    );
    if (fields[0]) fields[0].id = id;
    return {
      element: h("div", { class: "control vector" }, fields),
      update: (next) => {
        current = [...(next as number[])];
        fields.forEach((field, i) => (field.value = String(Number(Number(current[i]).toPrecision(6)))));
      },
    };
  }

  private color(parameter: ParameterDescription, value: ParameterValue, id: string, linear: boolean): Control {
    let current = [...(value as number[])];
    const picker = h("input", { id, type: "color", value: toHex(current, linear) });
    const fields = current.map((component, i) =>
      this.numberField(parameter, component, `${parameter.name} ${["red", "green", "blue"][i]}`, (next) => {
        current = current.map((old, k) => (k === i ? next : old));
        picker.value = toHex(current, linear);
        this.host.set(parameter.name, current);
      }),
    );
    const show = () => fields.forEach((field, i) => (field.value = String(Number(Number(current[i]).toPrecision(4)))));
    picker.addEventListener("input", () => {
      current = fromHex(picker.value, linear);
      show();
      this.host.set(parameter.name, current);
    });
    picker.addEventListener("change", () => this.host.end());
    return {
      element: h("div", { class: "control color" }, picker, fields),
      update: (next) => {
        current = [...(next as number[])];
        picker.value = toHex(current, linear);
        show();
      },
    };
  }
}
