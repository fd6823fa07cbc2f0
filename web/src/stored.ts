// SPDX-License-Identifier: Apache-2.0
// Values that stay in this browser (localStorage): layout, theme, progress of the lessons. A browser that forbids storage
// keeps them until the page is closed.

const kPrefix = "quintet-lab.";

export interface Stored<T> {
  value: T;
}

export function stored<T>(name: string, initial: T): Stored<T> {
  let current = initial;
  try {
    const text = localStorage.getItem(kPrefix + name);
    if (text !== null) {
      const parsed: unknown = JSON.parse(text);
      if (typeof parsed === typeof initial && (parsed === null) === (initial === null)) current = parsed as T;
    }
  } catch {
    // Not readable: the initial value counts.
  }
  return {
    get value() {
      return current;
    },
    set value(next: T) {
      current = next;
      try {
        localStorage.setItem(kPrefix + name, JSON.stringify(next));
      } catch {
        // Not writable: kept in memory.
      }
    },
  };
}
