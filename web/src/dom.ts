// SPDX-License-Identifier: Apache-2.0
// Small helpers to build parts of the page. Text is always set as text, never as HTML.

type Attributes = Record<string, string | number | boolean | undefined>;

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    if (name === "style") made.style.cssText = String(value);
    else made.setAttribute(name, value === true ? "" : String(value));
  }
  made.append(...children);
  return made;
}

export function button(
  label: string,
  title: string,
  onClick: () => void,
  attributes: Attributes = {},
): HTMLButtonElement {
  const made = element("button", { type: "button", title, "aria-label": title, ...attributes }, label);
  made.addEventListener("click", onClick);
  return made;
}

export type Row = [string, string | Node];

/** Names beside their values. */
export function table(rows: Row[]): HTMLElement {
  const list = element("dl");
  for (const [name, value] of rows) list.append(element("dt", {}, name), element("dd", {}, value));
  return list;
}

export function byId(id: string): HTMLElement {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no part '${id}'`);
  return found;
}

export function percent(share: number | null | undefined): string {
  return share === null || share === undefined ? "–" : `${(100 * share).toFixed(0)} %`;
}

export function metres(value: number): string {
  if (Math.abs(value) >= 1) return `${value.toFixed(3)} m`;
  return `${(1000 * value).toFixed(Math.abs(value) < 0.01 ? 1 : 0)} mm`;
}

export function coordinates(p: readonly number[]): string {
  return p.map((value) => value.toFixed(3)).join(", ");
}

export function download(name: string, blob: Blob): void {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
