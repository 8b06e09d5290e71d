// SPDX-License-Identifier: GPL-3.0-or-later
// Builds page.html, the page without its data, and LICENSES, what the packages inside it ask for, from src/.
// `node build.mjs DIR` writes them into DIR instead of here.

import { build } from "esbuild";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const target = process.argv[2] ?? here;

const result = await build({
  absWorkingDir: here,
  entryPoints: ["src/main.js"],
  outdir: "out",
  bundle: true,
  minify: true,
  format: "iife",
  target: ["chrome111", "firefox115", "safari16.4"],
  charset: "utf8",
  preserveSymlinks: true, // report/check links to the packages
  legalComments: "none", // LICENSES has them whole
  loader: { ".woff2": "dataurl" },
  metafile: true,
  write: false,
});

// The packages of which something is inside, with their licences.
function listPackages(inputs) {
  const names = new Set();
  for (const path of inputs) {
    const match = /^node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(path);
    if (match) names.add(match[1]);
  }
  return [...names].sort().map((name) => {
    const folder = join(here, "node_modules", name);
    const { version, license } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
    const file = readdirSync(folder).find((one) => /^licen[cs]e/i.test(one));
    if (!file) throw new Error(`${name} has no licence file`);
    return { name, version, license, text: readFileSync(join(folder, file), "utf8").replaceAll("\r", "").trim() };
  });
}

function licencesOf(packages) {
  const texts = new Map();
  for (const { name, version, license, text } of packages) {
    const heads = texts.get(text) ?? [];
    heads.push(`${name} ${version} (${license})`);
    texts.set(text, heads);
  }
  const parts = [...texts].map(([text, heads]) => `${heads.join("\n")}\n\n${text}\n`);
  return `The page that tetlap report writes contains these packages.\n\n${"-".repeat(80)}\n${parts.join(`\n${"-".repeat(80)}\n`)}`;
}

const output = (end) => result.outputFiles.find((file) => file.path.endsWith(end)).text.trim();
// What has bytes in the output, and the font, which stands in the style sheet.
const inputs = Object.keys(result.metafile.inputs);
const script = Object.entries(result.metafile.outputs).find(([path]) => path.endsWith(".js"))[1];
const inside = inputs.filter((path) => path.endsWith(".woff2") || script.inputs[path]?.bytesInOutput > 0);
const licences = licencesOf(listPackages(inside));
const parts = {
  style: output(".css"),
  script: output(".js").replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--"),
  licences: licences.replaceAll("<", "‹").replaceAll(">", "›"),
};
const page = readFileSync(join(here, "src/page.html"), "utf8").replace(/\{\{(\w+)\}\}/g, (_, name) => parts[name]);
writeFileSync(join(target, "page.html"), page);
writeFileSync(join(target, "LICENSES"), licences);
