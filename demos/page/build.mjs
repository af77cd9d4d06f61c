// Bundles the page into one file without any reference to another: build.mjs OUTPUT.html
import {build} from 'esbuild';
import {mkdir, readFile, writeFile} from 'node:fs/promises';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const output = process.argv[2] ?? join(here, 'pintle_page.html');

const bundle = async (entry) => {
  const result = await build({
    entryPoints: [join(here, 'src', entry)],
    bundle: true,
    minify: true,
    write: false,
    format: 'iife',
    target: 'es2021',
    legalComments: 'none',
    logLevel: 'warning',
  });
  return result.outputFiles[0].text;
};

const license = async (name) =>
  `${name}\n${(await readFile(join(here, 'node_modules', name, 'LICENSE'), 'utf8')).trim()}`;

const [script, style, html, ...licenses] = await Promise.all([
  bundle('main.ts'), bundle('style.css'), readFile(join(here, 'src', 'index.html'), 'utf8'),
  license('three'), license('uplot'),
]);
// What would end the element early is written otherwise.
const page = html.replace('<!-- style -->', () => `<style>${style}</style>`)
  .replace('<!-- script -->', () => `<script>${script.replaceAll('</script', '<\\/script')}</script>`)
  .replace('<!-- licenses -->', () => `<!--\n${licenses.join('\n\n').replaceAll('--', '- -')}\n-->`);
await mkdir(dirname(output), {recursive: true});
await writeFile(output, page);
console.log(`${output}: ${(page.length / 1024).toFixed(0)} KiB`);
