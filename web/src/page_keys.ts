// SPDX-License-Identifier: Apache-2.0
// Keys of the whole page, the order in which F6 visits its areas, and files that are dropped on it.

export interface PageKeys {
  choose: () => void;
  save: () => void;
  help: () => void;
  upload: (files: readonly File[]) => void;
}

// An area, and the element in it that gets the focus.
export type Area = [HTMLElement, string];

function nextArea(areas: readonly Area[], back: boolean): void {
  const shown = areas.filter(([area]) => area.offsetParent !== null);
  const index = shown.findIndex(([area]) => area.contains(document.activeElement));
  const [area, target] = shown[(index + (back ? -1 : 1) + shown.length) % shown.length]!;
  area.querySelector<HTMLElement>(target)?.focus();
}

export function connectKeys(keys: PageKeys, areas: () => readonly Area[]): void {
  document.addEventListener("keydown", (event) => {
    const control = event.ctrlKey || event.metaKey;
    if (control && event.key.toLowerCase() === "o") keys.choose();
    else if (control && event.key.toLowerCase() === "s") keys.save();
    else if (event.key === "F1") keys.help();
    else if (event.key === "F6") nextArea(areas(), event.shiftKey);
    else return;
    event.preventDefault();
  });
}

export function connectDrops(upload: PageKeys["upload"]): void {
  let depth = 0;
  const isFile = (event: DragEvent) => event.dataTransfer?.types.includes("Files") === true;
  document.addEventListener("dragenter", (event) => {
    if (isFile(event) && ++depth === 1) document.body.classList.add("dropping");
  });
  document.addEventListener("dragleave", (event) => {
    if (isFile(event) && --depth <= 0) document.body.classList.remove("dropping");
  });
  document.addEventListener("dragover", (event) => {
    if (isFile(event)) event.preventDefault();
  });
  document.addEventListener("drop", (event) => {
    depth = 0;
    document.body.classList.remove("dropping");
    if (!isFile(event)) return;
    event.preventDefault();
    upload([...event.dataTransfer!.files]);
  });
}
