// Bundles each page's program and style into one file each: build.js OUT (default build/web of the source tree).
import { build } from "esbuild";
import { existsSync, mkdirSync, renameSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = resolve(process.argv[2] ?? join(here, "../../../build/web"));
mkdirSync(out, { recursive: true });

for (const page of ["report", "viewer"]) {
  const entry = join(here, "src", page, "main.js");
  if (!existsSync(entry)) continue;
  await build({
    entryPoints: { [`${page}.new`]: entry },
    outdir: out,
    bundle: true,
    minify: true,
    format: "iife",
    target: "es2022",
    charset: "utf8",
    legalComments: "inline",
    logLevel: "warning",
  });
  // A report that is written meanwhile finds the old files or the new ones.
  for (const ending of ["js", "css"])
    renameSync(join(out, `${page}.new.${ending}`), join(out, `${page}.${ending}`));
}
console.log(`web: ${out}`);
