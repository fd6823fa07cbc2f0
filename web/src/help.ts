// SPDX-License-Identifier: Apache-2.0
// The list of keys (F1).
import { openSheet } from "./dialog";
import { h } from "./dom";
import type { Project } from "./protocol";

const kKeys: readonly [string, readonly [string, string][]][] = [
  ["Page", [["Ctrl+O", "Open a program"], ["Ctrl+S", "Save now; edits are saved automatically after a moment"], ["F6, Shift+F6", "Next or previous area"], ["F1", "This help"]]],
  [
    "Editor",
    [
      ["Ctrl+Space", "Complete a name"],
      ["Ctrl+F", "Find and replace"],
      ["F8", "Next problem"],
      ["Ctrl+/", "Comment or uncomment lines"],
      ["Shift+Alt+F", "Format"],
      ["Ctrl+Z, Ctrl+Y", "Undo, redo"],
      ["Escape, then Tab", "Leave the editor"],
    ],
  ],
  [
    "Image",
    [
      ["Drag", "Turn the camera"],
      ["Shift + drag, middle button", "Move the camera sideways"],
      ["Wheel, right button", "Zoom"],
      ["Double click", "Turn around this point"],
      ["Click, Enter", "Explain the pixel: rays, payloads, source lines"],
      ["Arrow keys, + and −", "Turn and zoom"],
      ["W A S D E Q", "Fly; with Shift, faster"],
      ["Home", "Show the whole scene"],
    ],
  ],
];

export function showHelp(project: Project | undefined): void {
  openSheet(
    "Keys",
    h(
      "div",
      {},
      kKeys.map(([title, rows]) => [h("h3", {}, title), h("table", { class: "keys" }, h("tbody", {}, rows.map(([key, text]) => h("tr", {}, h("th", { scope: "row" }, key), h("td", {}, text)))))]),
      h("p", {}, `Quintet ${project?.version ?? ""}. Files are in ${project?.folder ?? ""}. They are plain files: the commands quintet run and quintet check work with them, too.`),
    ),
  );
}
