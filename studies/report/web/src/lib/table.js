// A table that sorts by its headings and tells so to screen readers.
import { el } from "./dom.js";

/**
 * columns: [{label, title, text: row -> string or node, key: row -> number or string (sorts by it), left}].
 * options: {caption, sort: index, down: bool, rowClass: row -> string, onSort: (index, down) -> void}.
 */
export function sortedTable(columns, rows, options = {}) {
  let by = options.sort ?? -1,
    down = options.down ?? false;
  const body = el("tbody");
  const heads = columns.map((column, i) =>
    el(
      "th",
      { scope: "col", class: column.left && "left", title: column.title },
      column.key
        ? el("button", { type: "button", class: "sort", onclick: () => choose(i) }, column.label)
        : column.label,
    ),
  );
  const draw = () => {
    const shown =
      by < 0
        ? rows
        : [...rows].sort((a, b) => (down ? -1 : 1) * order(columns[by].key(a), columns[by].key(b)));
    heads.forEach((head, i) => {
      if (columns[i].key)
        head.setAttribute("aria-sort", i !== by ? "none" : down ? "descending" : "ascending");
    });
    body.replaceChildren(
      ...shown.map((row) =>
        el(
          "tr",
          { class: options.rowClass?.(row) },
          columns.map((column, i) =>
            el(
              i === 0 ? "th" : "td",
              { scope: i === 0 && "row", class: column.left && "left" },
              column.text(row),
            ),
          ),
        ),
      ),
    );
  };
  const choose = (i) => {
    down = i === by ? !down : (columns[i].downFirst ?? false);
    by = i;
    options.onSort?.(by, down);
    draw();
  };
  draw();
  return el(
    "div",
    { class: "wide", tabindex: 0, role: "region", "aria-label": options.caption },
    el(
      "table",
      {},
      el("caption", { class: "hidden" }, options.caption),
      el("thead", {}, el("tr", {}, heads)),
      body,
    ),
  );
}

/** Numbers before texts, none last. */
export function order(a, b) {
  const none = (value) => value === null || value === undefined || Number.isNaN(value);
  if (none(a) || none(b)) return none(a) - none(b);
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a).localeCompare(String(b), "en", { numeric: true });
}

/** The numbers of a picture, for who does not see it. */
export const tableBehind = (columns, rows, caption) =>
  el(
    "details",
    { class: "behind" },
    el("summary", {}, "The numbers of this picture"),
    sortedTable(columns, rows, { caption }),
  );
