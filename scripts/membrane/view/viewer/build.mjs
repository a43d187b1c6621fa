// SPDX-License-Identifier: GPL-2.0-or-later
// Bundles the viewer into one HTML file: `node build.mjs OUTPUT`. __RUN__ in it stands for a run's results.

import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";

const [output] = process.argv.slice(2);
const { outputFiles } = await build({
  entryPoints: ["src/main.js"],
  bundle: true,
  format: "iife",
  legalComments: "inline",
  minify: true,
  target: "es2021",
  write: false,
});
const script = outputFiles[0].text.replaceAll("</script", "<\\/script");
const parts = { __STYLE__: readFileSync("src/style.css", "utf8"), __SCRIPT__: script };
const page = readFileSync("src/page.html", "utf8").replace(/__STYLE__|__SCRIPT__/g, (name) => parts[name]);
if (page.split("__RUN__").length !== 2) throw new Error("__RUN__ must stand exactly once in the page");
writeFileSync(output, page);
