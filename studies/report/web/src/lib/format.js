// Numbers as the text tables print them.

const MINUS = "−";

/** `decimals` digits after the point; "–" for none. Large numbers keep four digits, and thousands a comma as counts do. */
export function number(value, decimals = 2) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const size = Math.abs(value);
  const digits = size >= 999.95 ? 0 : size >= 99.995 ? Math.min(decimals, 1) : decimals;
  const text = value.toFixed(digits).replace("-", MINUS);
  return size >= 1000 ? text.replace(/\B(?=(\d{3})+$)/g, ",") : text;
}

/** "8.13–13.19", "−3.65 to −0.05", "" where there is no interval. */
export const interval = (lo, hi, decimals) =>
  lo === null || lo === undefined || hi === null || hi === undefined
    ? ""
    : `${number(lo, decimals)}${lo < 0 || hi < 0 ? " to " : "–"}${number(hi, decimals)}`;

/** "10.66 kJ (8.13–13.19)". */
export function withInterval(cell, metric) {
  if (!cell || cell.value === null) return "none";
  const range = interval(cell.lo, cell.hi, metric.decimals);
  return `${number(cell.value, metric.decimals)} ${metric.unit}${range && ` (${range})`}`.trim();
}

export const pValue = (p) =>
  p === null || p === undefined ? "" : p < 0.0001 ? "<0.0001" : p.toFixed(p < 0.01 ? 4 : 3);

export const count = (n) => n.toLocaleString("en-GB");

export const plural = (n, one, many = `${one}s`) => `${count(n)} ${n === 1 ? one : many}`;
