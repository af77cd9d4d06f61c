// Prints after how long a page is shown, and how many frames a second it draws as it plays, in software rendering. Nothing else should
// run beside it. measure.sh calls it.
const {chromium} = await import(process.env.PINTLE_PLAYWRIGHT);
const [gallery, many] = process.argv.slice(2);
const browser = await chromium.launch({
  executablePath: process.env.PINTLE_BROWSER,
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
});
const open = async (file) => {
  const page = await browser.newPage({viewport: {width: 1280, height: 720}});
  await page.goto(`file://${file}`);
  return page;
};

const shown = [];
for (let load = 0; load < 4; ++load) {
  const page = await open(gallery);
  await page.waitForFunction(() => performance.getEntriesByName('shown').length > 0);
  shown.push(await page.evaluate(() => performance.getEntriesByName('shown')[0].startTime / 1000));
  await page.close();
}
console.log(`all scenes are shown after ${shown.map((s) => s.toFixed(2)).join(', ')} s`);

const page = await open(`${many}#scene=many`);
const rates = [];
for (let part = 0; part < 7; ++part) {
  await page.evaluate(() => window.pintle.state().playing || document.getElementById('play').click());
  await page.waitForTimeout(2500);
  rates.push(await page.evaluate(() => window.pintle.state().framesPerSecond));
}
const settled = rates.slice(1);  // the page first finds how finely it can draw
const panes = await page.evaluate(() => window.pintle.state().panes?.length ?? 0);
console.log(`${settled.map((r) => r.toFixed(1)).join(', ')} frames a second, mean ${(settled.reduce((a, b) => a + b) / settled.length).toFixed(1)} (${panes} panes)`);
await browser.close();
