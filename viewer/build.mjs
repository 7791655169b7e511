// Builds the page into dist/: node build.mjs
import { copyFile, mkdir, rm } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { fileURLToPath } from 'node:url';

import { build } from 'esbuild';

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const packages = createRequire(import.meta.url);

await rm(here('dist'), { recursive: true, force: true });
await mkdir(here('dist'), { recursive: true });
await build({
  entryPoints: { viewer: here('app/main.js'), decode_worker: here('decode/worker.js') },
  outdir: here('dist'),
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2022',
  // The decoder's glue asks for these only when it runs in node.
  external: ['fs', 'path'],
  logLevel: 'warning',
});
for (const file of ['index.html', 'viewer.css']) await copyFile(here(`app/${file}`), here(`dist/${file}`));
await copyFile(packages.resolve('draco3d/draco_decoder.wasm'), here('dist/draco_decoder.wasm'));
