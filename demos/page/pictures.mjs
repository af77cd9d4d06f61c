// Takes the README's pictures of the page, drawn with all that a graphics card would draw.
//   pictures.mjs PAGE.html OUTPUT_DIR    after build.sh; the browser is chromium, or what PINTLE_BROWSER names
import {createRequire} from 'node:module';
import {dirname, join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [, , file, output] = process.argv;
const build = resolve(dirname(file), 'release', 'page', 'work', 'package.json');
const {chromium} = createRequire(build)('playwright-core');
const pictures = [
  {scene: 'rope_bridge', time: 1.5, panes: ['stock', 'exact'], theme: 'light'},
  {scene: 'stairs', time: 1.05, panes: ['stock', 'exact'], theme: 'light'},
  {scene: 'wrecking_ball', time: 1.6, panes: ['stock', 'pintle', 'exact'], theme: 'dark'},
];

const browser = await chromium.launch({
  executablePath: process.env.PINTLE_BROWSER ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
});
for (const {scene, time, panes, theme} of pictures) {
  const page = await browser.newPage({viewport: {width: 1280, height: 720}, colorScheme: theme, reducedMotion: 'reduce'});
  const fragment = new URLSearchParams([['scene', scene], ['time', time], ...panes.map((pane) => ['pane', pane])]);
  await page.goto(`${pathToFileURL(resolve(file))}?full#${fragment}`);
  await page.evaluate(() => document.activeElement.blur());
  await page.waitForTimeout(3000);  // fonts, and the first pictures of all panes
  await page.screenshot({path: join(output, `page_${scene}.png`)});
  await page.close();
}
await browser.close();
