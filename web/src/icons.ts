// SPDX-License-Identifier: Apache-2.0
// Icons as paths in a square of 16, drawn with the color of the text.
import { svg } from "./dom";

const kPaths = {
  play: "M4.5 2.8v10.4L13 8z",
  pause: "M4 3h3v10H4zM9 3h3v10H9z",
  next: "M3 2.8v10.4L10.6 8zM11.5 3H13.5v10h-2z",
  first: "M13 2.8v10.4L5.4 8zM2.5 3h2v10h-2z",
  undo: "M6.2 2.2 2.4 6l3.8 3.8V7.2h3.3a2.8 2.8 0 0 1 0 5.6H6v1.6h3.5a4.4 4.4 0 0 0 0-8.8H6.2z",
  redo: "M9.8 2.2 13.6 6 9.8 9.8V7.2H6.5a2.8 2.8 0 0 0 0 5.6H10v1.6H6.5a4.4 4.4 0 0 1 0-8.8h3.3z",
  download: "M7.2 2h1.6v6.2l2.4-2.4 1.1 1.1L8 11.2 3.7 6.9l1.1-1.1 2.4 2.4zM2.5 12.4h11V14h-11z",
  find: "M7 2.2a4.8 4.8 0 1 0 2.9 8.6l3 3 1.2-1.2-3-3A4.8 4.8 0 0 0 7 2.2zm0 1.7a3.1 3.1 0 1 1 0 6.2 3.1 3.1 0 0 1 0-6.2z",
  format: "M2 3h12v1.5H2zM5 6.2h9v1.5H5zM5 9.4h6v1.5H5zM2 12.5h9V14H2z",
  columns: "M2 2.5h12v11H2zm1.5 1.5v8h3.7V4zm5.2 0v8h3.8V4z",
  copy: "M5.5 1.5h8v10h-2v-1.6h.4V3.1H7.1v.4H5.5zM2.5 4.5h8v10h-8zm1.6 1.6v6.8h4.8V6.1z",
  close: "M3.9 2.8 8 6.9l4.1-4.1 1.1 1.1L9.1 8l4.1 4.1-1.1 1.1L8 9.1l-4.1 4.1-1.1-1.1L6.9 8 2.8 3.9z",
  reset: "M8 2.6a5.4 5.4 0 1 0 5.2 6.9h-1.7A3.8 3.8 0 1 1 8 4.2c1 0 1.9.4 2.6 1L8.8 7h4.7V2.3l-1.8 1.8A5.4 5.4 0 0 0 8 2.6z",
} as const;

export type IconName = keyof typeof kPaths;

export function icon(name: IconName): SVGElement {
  return svg("svg", { class: "glyph", viewBox: "0 0 16 16", "aria-hidden": "true" }, svg("path", { d: kPaths[name] }));
}
