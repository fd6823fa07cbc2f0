// SPDX-License-Identifier: Apache-2.0
// Colors of pickers (sRGB, "#rrggbb") and of parameters. Parameters of folders are linear; those of the lecture form are
// display values, which the picker shows unchanged.

const encode = (value: number) => (value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055);
const decode = (value: number) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);

// Components above 1 are scaled, so that the picker shows the hue.
export function toHex(color: readonly number[], linear: boolean): string {
  const scale = Math.max(1, ...color.slice(0, 3));
  return `#${color
    .slice(0, 3)
    .map((value) => {
      const unit = Math.max(0, value / scale);
      const byte = Math.round(255 * Math.min(1, linear ? encode(unit) : unit));
      return byte.toString(16).padStart(2, "0");
    })
    .join("")}`;
}

export function fromHex(hex: string, linear: boolean): [number, number, number] {
  const bytes = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
  return bytes.map((value) => Math.round((linear ? decode(value) : value) * 1e4) / 1e4) as [number, number, number];
}
