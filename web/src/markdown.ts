// SPDX-License-Identifier: Apache-2.0
// Markdown of the project's pages as elements: headings, paragraphs, lists, tables, code, quotes, images, links and
// emphasis. Comments on lines of their own are not shown; other HTML stays text.
import { h } from "./dom";

export interface MarkdownOptions {
  // Address of an image; undefined shows its description instead.
  image?: (target: string) => string | undefined;
  // Called for a link; returns the element that represents it. Without it, only https links are links.
  link?: (target: string, content: Node[]) => Node | undefined;
  // Colored code; plain text without it.
  code?: (text: string, language: string) => Node;
  // Returns the element that represents a block of code, undefined for an ordinary one. `comments`: those above it.
  block?: (text: string, language: string, comments: readonly string[]) => Node | undefined;
  // 1: a heading of level 1 becomes h1
  firstHeading?: number;
}

// Inline elements of one paragraph.
export function inlineMarkdown(text: string, options: MarkdownOptions = {}): Node[] {
  const nodes: Node[] = [];
  let plain = "";
  const flush = () => {
    if (plain) nodes.push(document.createTextNode(plain));
    plain = "";
  };
  for (let i = 0; i < text.length; ) {
    const rest = text.slice(i);
    const code = /^(`+)([\s\S]*?[^`])\1(?!`)/.exec(rest);
    if (code) {
      flush();
      nodes.push(h("code", {}, code[2]!.replace(/^ (.*) $/, "$1")));
      i += code[0].length;
      continue;
    }
    const image = /^!\[([^\]]*)\]\(([^)\s]*)\)/.exec(rest);
    if (image) {
      flush();
      const source = options.image?.(image[2]!);
      nodes.push(source ? h("img", { src: source, alt: image[1]!, loading: "lazy" }) : h("em", {}, image[1]!));
      i += image[0].length;
      continue;
    }
    const link = /^\[((?:!\[[^\]]*\]\([^)]*\)|`[^`]*`|[^\]`])*)\]\(([^)\s]*)\)/.exec(rest);
    if (link) {
      flush();
      const content = inlineMarkdown(link[1]!, options);
      const target = link[2]!;
      const element = options.link?.(target, content);
      if (element) nodes.push(element);
      else if (/^https:\/\//.test(target)) nodes.push(h("a", { href: target, target: "_blank", rel: "noopener noreferrer" }, content));
      else nodes.push(...content);
      i += link[0].length;
      continue;
    }
    const bare = /^<(https:\/\/[^>\s]+)>/.exec(rest);
    if (bare) {
      flush();
      nodes.push(h("a", { href: bare[1]!, target: "_blank", rel: "noopener noreferrer" }, bare[1]!));
      i += bare[0].length;
      continue;
    }
    const strong = /^\*\*(?=\S)([\s\S]*?\S)\*\*/.exec(rest);
    const emphasis = strong ?? /^\*(?=[^\s*])([\s\S]*?[^\s*])\*(?!\*)/.exec(rest);
    if (emphasis) {
      flush();
      nodes.push(h(strong ? "strong" : "em", {}, inlineMarkdown(emphasis[1]!, options)));
      i += emphasis[0].length;
      continue;
    }
    if (rest[0] === "\\" && /^\\[\\`*_{}[\]()#+\-.!|<>]/.test(rest)) {
      plain += rest[1];
      i += 2;
      continue;
    }
    plain += rest[0];
    ++i;
  }
  flush();
  return nodes;
}

function cells(row: string): string[] {
  const inner = row.trim().replace(/^\|/, "").replace(/\|$/, "");
  return inner
    .replaceAll("\\|", "\u0001")
    .split("|")
    .map((cell) => cell.trim().replaceAll("\u0001", "|"));
}

function table(rows: string[], options: MarkdownOptions): Node {
  const head = cells(rows[0]!);
  const hasHead = head.some((cell) => cell !== "");
  return h(
    "div",
    { class: "table" },
    h(
      "table",
      {},
      hasHead && h("thead", {}, h("tr", {}, head.map((cell) => h("th", { scope: "col" }, inlineMarkdown(cell, options))))),
      h("tbody", {}, rows.slice(2).map((row) => h("tr", {}, cells(row).map((cell) => h("td", {}, inlineMarkdown(cell, options)))))),
    ),
  );
}

const kListItem = /^(\s*)([*+-]|\d+\.)\s+(.*)$/;

function list(lines: string[], options: MarkdownOptions): Node {
  const first = kListItem.exec(lines[0]!)!;
  const items: string[][] = [];
  for (const line of lines) {
    const item = kListItem.exec(line);
    if (item && item[1]!.length === first[1]!.length) items.push([item[3]!]);
    else items[items.length - 1]!.push(line.replace(new RegExp(`^\\s{0,${first[0].length - first[3]!.length}}`), ""));
  }
  const tag = /\d/.test(first[2]!) ? "ol" : "ul";
  return h(
    tag,
    {},
    items.map((item) => {
      const blocks = markdownBlocks(item.join("\n"), options);
      const only = blocks.length > 0 && blocks[0] instanceof HTMLParagraphElement ? [...blocks[0].childNodes] : [];
      return h("li", {}, only, only.length > 0 ? blocks.slice(1) : blocks);
    }),
  );
}

function markdownBlocks(text: string, options: MarkdownOptions): Node[] {
  const lines = text.replace(/\r/g, "").split("\n");
  const blocks: Node[] = [];
  const takeWhile = (from: number, test: (line: string, index: number) => boolean) => {
    let end = from;
    while (end < lines.length && test(lines[end]!, end)) ++end;
    return end;
  };
  let comments: string[] = []; // directly above the next block
  const pre = (code: string, language: string) => options.block?.(code, language, comments) ?? h("pre", { tabindex: 0 }, options.code?.(code, language) ?? h("code", {}, code));
  let commented = 0; // number of blocks when the last of them was read
  for (let i = 0; i < lines.length; ) {
    const line = lines[i]!;
    if (line.trim() === "") {
      ++i;
      continue;
    }
    if (blocks.length !== commented) {
      comments = [];
      commented = blocks.length;
    }
    if (line.startsWith("<!--")) {
      const end = takeWhile(i, (other) => !other.includes("-->"));
      const comment = lines.slice(i, end + 1).join("\n").replace(/^<!--/, "").replace(/-->[\s\S]*$/, "").trim();
      i = end + 1;
      comments.push(comment);
      continue;
    }
    const fence = /^(```+|~~~+)\s*(\w*)/.exec(line);
    if (fence) {
      const end = takeWhile(i + 1, (other) => !other.startsWith(fence[1]!));
      const code = lines.slice(i + 1, end).join("\n");
      blocks.push(pre(code, fence[2]!));
      i = end + 1;
      continue;
    }
    const heading = /^(#{1,6})\s+(.*?)\s*#*$/.exec(line);
    if (heading) {
      const level = Math.min(6, heading[1]!.length + (options.firstHeading ?? 1) - 1);
      blocks.push(h(`h${level}` as "h1", {}, inlineMarkdown(heading[2]!, options)));
      ++i;
      continue;
    }
    if (/^ {4}/.test(line)) {
      let end = takeWhile(i, (other) => /^ {4}/.test(other) || other.trim() === "");
      while (lines[end - 1]!.trim() === "") --end;
      const code = lines.slice(i, end).map((other) => other.slice(4)).join("\n");
      blocks.push(pre(code, ""));
      i = end;
      continue;
    }
    if (line.startsWith("|") && /^\|?[\s:|-]+\|?$/.test(lines[i + 1] ?? "")) {
      const end = takeWhile(i, (other) => other.startsWith("|"));
      blocks.push(table(lines.slice(i, end), options));
      i = end;
      continue;
    }
    if (/^>/.test(line)) {
      const end = takeWhile(i, (other) => /^>/.test(other));
      blocks.push(h("blockquote", {}, markdownBlocks(lines.slice(i, end).map((other) => other.replace(/^> ?/, "")).join("\n"), options)));
      i = end;
      continue;
    }
    if (kListItem.test(line)) {
      const end = takeWhile(i, (other, index) => index === i || kListItem.test(other) || /^\s+\S/.test(other) || (other.trim() === "" && /^\s+\S|^\s*([*+-]|\d+\.)\s/.test(lines[index + 1] ?? "")));
      blocks.push(list(lines.slice(i, end), options));
      i = end;
      continue;
    }
    const end = takeWhile(i, (other, index) => index === i || (other.trim() !== "" && !/^(#{1,6}\s|```|>|\|)/.test(other) && !kListItem.test(other)));
    blocks.push(h("p", {}, inlineMarkdown(lines.slice(i, end).join(" "), options)));
    i = end;
  }
  return blocks;
}

export function renderMarkdown(text: string, options: MarkdownOptions = {}): DocumentFragment {
  const fragment = document.createDocumentFragment();
  fragment.append(...markdownBlocks(text, options));
  return fragment;
}
