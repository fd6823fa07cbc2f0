// SPDX-License-Identifier: Apache-2.0
// Builds elements: h("button", {class: "primary", onclick: save}, "Save"). Text is never parsed as HTML.

export type Child = Node | string | number | null | undefined | false | Child[];
type Properties = Record<string, unknown>;

function append(parent: Node, children: readonly Child[]): void {
  for (const child of children) {
    if (Array.isArray(child)) append(parent, child);
    else if (child instanceof Node) parent.appendChild(child);
    else if (child !== null && child !== undefined && child !== false) parent.appendChild(document.createTextNode(String(child)));
  }
}

function assign(element: Element, properties: Properties): void {
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on") && typeof value === "function") element.addEventListener(name.slice(2), value as EventListener);
    else if (name === "dataset") Object.assign((element as HTMLElement).dataset, value);
    else element.setAttribute(name, value === true ? "" : String(value));
  }
}

export function h<K extends keyof HTMLElementTagNameMap>(tag: K, properties: Properties = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  assign(element, properties);
  append(element, children);
  return element;
}

export function svg<K extends keyof SVGElementTagNameMap>(tag: K, properties: Properties = {}, ...children: Child[]): SVGElementTagNameMap[K] {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  assign(element, properties);
  append(element, children);
  return element;
}

export function replace(parent: Element, ...children: Child[]): void {
  parent.replaceChildren();
  append(parent, children);
}

const shownOptions = new WeakMap<HTMLSelectElement, string>();

// The options of a list as [value, label, title]. Nothing changes if it has them already, so that an open list stays open.
export function setOptions(select: HTMLSelectElement, options: readonly (readonly [string, string, string?])[]): void {
  const key = JSON.stringify(options);
  if (shownOptions.get(select) === key) return;
  shownOptions.set(select, key);
  replace(select, options.map(([value, label, title]) => h("option", { value, title: title || undefined }, label)));
}

let nextId = 0;
export function uniqueId(prefix: string): string {
  return `${prefix}-${++nextId}`;
}
