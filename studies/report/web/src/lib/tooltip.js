// One box that follows the pointer or the focus. Lines are text.
import { el } from "./dom.js";

let box;

export function installTooltip() {
  box = el("div", { id: "tooltip", role: "tooltip", hidden: true });
  document.body.append(box);
  addEventListener("keydown", (event) => {
    if (event.key === "Escape") hideTooltip();
  });
  addEventListener("scroll", hideTooltip, { passive: true });
}

export function showTooltip(lines, x, y) {
  box.replaceChildren(...lines.filter(Boolean).map((line, i) => el(i === 0 ? "strong" : "span", {}, line)));
  box.hidden = false;
  const width = box.offsetWidth,
    height = box.offsetHeight;
  box.style.left = `${Math.max(4, Math.min(x + 14, window.innerWidth - width - 8))}px`;
  box.style.top = `${y + height + 22 > window.innerHeight ? Math.max(4, y - height - 10) : y + 16}px`;
}

export function hideTooltip() {
  box.hidden = true;
}

/** Shows what `lines()` gives while the pointer or the focus is on the mark. */
export function withTooltip(node, lines) {
  node.addEventListener("pointermove", (event) => showTooltip(lines(), event.clientX, event.clientY));
  node.addEventListener("pointerleave", hideTooltip);
  node.addEventListener("focus", () => {
    const place = node.getBoundingClientRect();
    if (node.matches(":focus-visible")) showTooltip(lines(), place.right, place.top);
  });
  node.addEventListener("blur", hideTooltip);
  return node;
}
