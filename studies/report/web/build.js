// Bundles each page's program and style into one file each: build.js OUT (default build/web of the source tree).
import { build } from "esbuild";
import { existsSync, mkdirSync, readFileSync, renameSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = resolve(process.argv[2] ?? join(here, "../../../build/web"));
mkdirSync(out, { recursive: true });

// The licences of the libraries that went into a bundle: their terms ask for them in every copy.
function licences(metafile) {
  const packages = new Set(
    Object.keys(metafile.inputs)
      .map((input) => /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(input)?.[1])
      .filter(Boolean),
  );
  return [...packages].sort().map((name) => {
    const file = join(here, "node_modules", name, "LICENSE");
    const text = existsSync(file) ? readFileSync(file, "utf8").trim() : "see its package.json";
    return `/*! ${name}\n${text.replaceAll("*/", "* /")}\n*/\n`;
  });
}

for (const page of ["report", "viewer"]) {
  const entry = join(here, "src", page, "main.js");
  if (!existsSync(entry)) continue;
  const { metafile } = await build({
    entryPoints: { [`${page}.new`]: entry },
    outdir: out,
    bundle: true,
    minify: true,
    format: "iife",
    target: "es2022",
    charset: "utf8",
    legalComments: "inline",
    logLevel: "warning",
    metafile: true,
  });
  const script = join(out, `${page}.new.js`);
  writeFileSync(script, licences(metafile).join("") + readFileSync(script, "utf8"));
  // A report that is written meanwhile finds the old files or the new ones.
  for (const ending of ["js", "css"])
    renameSync(join(out, `${page}.new.${ending}`), join(out, `${page}.${ending}`));
}
console.log(`web: ${out}`);
