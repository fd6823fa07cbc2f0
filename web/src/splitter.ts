// SPDX-License-Identifier: Apache-2.0
// A bar between two panes that the pointer or the arrow keys move. The share of the first pane is kept in the browser.
import { h } from "./dom";
import { stored } from "./stored";

export interface SplitterOptions {
  name: string; // of the stored share
  label: string;
  vertical: boolean; // panes above each other
  share: number; // of the first pane, at first
  minFirst: number; // pixels
  minSecond: number;
}

export interface Split {
  element: HTMLElement;
  // A hidden pane leaves all space to the other one.
  setHidden: (first: boolean, second: boolean) => void;
}

export function split(first: HTMLElement, second: HTMLElement, options: SplitterOptions): Split {
  const share = stored(`split.${options.name}`, options.share);
  const bar = h("div", {
    class: "splitter",
    role: "separator",
    tabindex: 0,
    "aria-label": options.label,
    "aria-orientation": options.vertical ? "horizontal" : "vertical",
    "aria-valuemin": 0,
    "aria-valuemax": 100,
  });
  const element = h("div", { class: `split ${options.vertical ? "rows" : "columns"}` }, first, bar, second);
  let hiddenFirst = false;
  let hiddenSecond = false;
  const extent = () => (options.vertical ? element.clientHeight : element.clientWidth);

  const apply = () => {
    first.hidden = hiddenFirst;
    second.hidden = hiddenSecond;
    bar.hidden = hiddenFirst || hiddenSecond;
    const property = options.vertical ? "minHeight" : "minWidth";
    first.style.flex = hiddenSecond ? "1 1 0" : `${share.value} 1 0`;
    second.style.flex = hiddenFirst ? "1 1 0" : `${1 - share.value} 1 0`;
    first.style[property] = `${options.minFirst}px`;
    second.style[property] = `${options.minSecond}px`;
    bar.setAttribute("aria-valuenow", String(Math.round(share.value * 100)));
  };
  const set = (value: number) => {
    const size = extent();
    if (size <= 0) return;
    const low = Math.min(0.5, options.minFirst / size);
    const high = Math.max(0.5, 1 - options.minSecond / size);
    share.value = Math.min(high, Math.max(low, value));
    apply();
  };
  bar.addEventListener("pointerdown", (event) => {
    bar.setPointerCapture(event.pointerId);
    bar.classList.add("dragging");
    const move = (moved: PointerEvent) => {
      const box = element.getBoundingClientRect();
      set(options.vertical ? (moved.clientY - box.top) / box.height : (moved.clientX - box.left) / box.width);
    };
    const end = () => {
      bar.classList.remove("dragging");
      bar.removeEventListener("pointermove", move);
      bar.removeEventListener("pointerup", end);
      bar.removeEventListener("pointercancel", end);
    };
    bar.addEventListener("pointermove", move);
    bar.addEventListener("pointerup", end);
    bar.addEventListener("pointercancel", end);
    event.preventDefault();
  });
  bar.addEventListener("dblclick", () => set(options.share));
  bar.addEventListener("keydown", (event) => {
    const less = options.vertical ? "ArrowUp" : "ArrowLeft";
    const more = options.vertical ? "ArrowDown" : "ArrowRight";
    if (event.key !== less && event.key !== more) return;
    set(share.value + (event.key === more ? 0.03 : -0.03));
    event.preventDefault();
  });
  apply();
  return {
    element,
    setHidden: (nextFirst, nextSecond) => {
      hiddenFirst = nextFirst;
      hiddenSecond = nextSecond;
      apply();
    },
  };
}
