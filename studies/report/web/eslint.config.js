import js from "@eslint/js";

const browser = Object.fromEntries(
  [
    "document",
    "window",
    "location",
    "history",
    "navigator",
    "console",
    "HTMLElement",
    "ResizeObserver",
    "requestAnimationFrame",
    "cancelAnimationFrame",
    "performance",
    "matchMedia",
    "getComputedStyle",
    "URLSearchParams",
    "Image",
    "atob",
    "setTimeout",
    "clearTimeout",
    "addEventListener",
    "Event",
    "devicePixelRatio",
  ].map((name) => [name, "readonly"]),
);
const node = { process: "readonly", console: "readonly", URL: "readonly", setTimeout: "readonly" };

export default [
  js.configs.recommended,
  { files: ["src/**"], languageOptions: { globals: browser } },
  { files: ["*.js", "test/**"], languageOptions: { globals: node } },
  { files: ["browser/**"], languageOptions: { globals: { ...browser, ...node, axe: "readonly" } } },
];
