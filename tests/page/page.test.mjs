// The page as a user has it: in a browser, with mouse and keys. What is drawn is read from the scene graph.
import assert from 'node:assert/strict';
import {readFileSync, statSync, writeFileSync} from 'node:fs';
import {after, before, test} from 'node:test';

const {chromium} = await import(process.env.PINTLE_PLAYWRIGHT);
const file = process.env.PINTLE_PAGE, pictures = process.env.PINTLE_PICTURES;
const html = readFileSync(file, 'utf8');
const open = '<script type="application/json" class="pintle-run">';
const runsOf = (page) => page.split(open).slice(1).map((part) => JSON.parse(part.slice(0, part.indexOf('</script>'))));
const runs = runsOf(html);
const scenes = [...new Set(runs.map((run) => run.scene))];

// The same page with other recordings, given as text.
const head = html.slice(0, html.indexOf(open)), tail = html.slice(html.indexOf('</script>', html.lastIndexOf(open)) + 9);
const writePage = (name, texts) => {
  writeFileSync(`${file}.${name}.html`, head + texts.map((text) => `${open}${text}</script>\n`).join('') + tail);
  return `file://${file}.${name}.html`;
};
const few = ['rope_bridge', 'car', 'valve', 'chain_heavy', 'limits_of_turns', 'bend_rim', 'chain'];  // they open sooner than all
const small = writePage('few', runs.filter((run) => few.includes(run.scene)).map((run) => JSON.stringify(run)));

const floats = (base64) => {
  const bytes = Buffer.from(base64, 'base64');
  return Array.from({length: bytes.length / 4}, (_, i) => bytes.readFloatLE(4 * i));
};

// What a run says of a frame: where points of its bodies are, and its contacts.
const turned = ([x, y, z, w], [a, b, c]) => {
  const s = [y * c - z * b, z * a - x * c, x * b - y * a];  // v + 2 w (q x v) + 2 q x (q x v)
  return [a + 2 * (w * s[0] + y * s[2] - z * s[1]), b + 2 * (w * s[1] + z * s[0] - x * s[2]), c + 2 * (w * s[2] + x * s[1] - y * s[0])];
};
const decoded = (run) => {
  const times = floats(run.times), poses = floats(run.poses), counts = floats(run.contacts.counts), contacts = floats(run.contacts.points);
  return {
    times,
    at: (index, frame, point) => {
      if (index < 0) return point;
      const {pose, track} = run.bodies[index], own = pose ?? poses.slice(7 * (track * times.length + frame)).slice(0, 7);
      return turned(own.slice(3, 7), point).map((value, i) => value + own[i]);
    },
    contacts: (frame) => {
      const start = counts.slice(0, frame).reduce((sum, count) => sum + count, 0);
      return Array.from({length: counts[frame]}, (_, i) => contacts.slice(4 * (start + i), 4 * (start + i) + 3));
    },
  };
};
const distance = (a, b) => Math.hypot(...a.map((value, i) => value - b[i]));
const points = (corners) => Array.from({length: corners.length / 3}, (_, i) => corners.slice(3 * i, 3 * i + 3));
const centre = (corners) => [0, 1, 2].map((axis) => points(corners).reduce((sum, point) => sum + point[axis], 0) / (corners.length / 3));
// Each of the points is among the others.
const areAmong = (some, others) => some.every((point) => others.some((other) => distance(point, other) < 1e-4));

let browser, page, errors;
const state = () => page.evaluate(() => window.pintle.state());
const newPage = async (options = {}) => {
  const made = await browser.newPage({viewport: {width: 640, height: 400}, reducedMotion: 'reduce', ...options});
  errors = [];
  made.on('console', (message) => message.type() === 'error' && errors.push(message.text()));
  made.on('pageerror', (error) => errors.push(error.message));
  made.on('request', (request) => request.url().startsWith('http') && errors.push(`asked for ${request.url()}`));
  return made;
};
const seek = (time) => page.evaluate((to) => {
  const scrubber = document.getElementById('scrubber');
  scrubber.value = String(to);
  scrubber.dispatchEvent(new Event('input'));
}, time).then(drawn);
const drawnIn = (pane) => page.evaluate((index) => window.pintle.drawn(index), pane);
const drawn = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

before(async () => {
  browser = await chromium.launch({
    executablePath: process.env.PINTLE_BROWSER,
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
  });
  page = await newPage();
  await page.goto(`file://${file}`);
});
after(() => browser?.close());

test('is small, and asks for nothing else', () => {
  assert.ok(statSync(file).size < 8e6, `${statSync(file).size} bytes`);
  assert.doesNotMatch(html, /<(script|link|img)[^>]+(src|href)="https?:/);
});

test('the gallery lists every scene', async () => {
  assert.deepEqual((await state()).scenes.map((scene) => scene.name), scenes);
  assert.equal(await page.locator('.card').count(), scenes.length);
  await page.locator('.card canvas.drawn').first().waitFor({timeout: 20000});
  await page.screenshot({path: `${pictures}/gallery.png`});
  assert.deepEqual(errors, []);
});

test('where Bullet has no joint for a scene, the page says so', () => {
  const without = scenes.filter((scene) => !runs.some((run) => run.scene === scene && run.name === 'stock'));
  assert.ok(without.length > 0);
  for (const run of runs) assert.equal(/Bullet has no such joint/.test(run.text), without.includes(run.scene), run.scene);
});

test('a contender has one colour, everywhere', () => {
  const colours = new Map();
  for (const run of runs) {
    assert.match(run.colour, /^#[0-9a-f]{6}$/, run.name);
    const contender = run.name.split(',')[0];
    assert.equal(colours.get(contender) ?? run.colour, run.colour, `${run.scene}, ${run.name}`);
    colours.set(contender, run.colour);
  }
  assert.equal(new Set(colours.values()).size, colours.size);
});

test('every scene opens, and its bodies stand as they were recorded', async () => {
  for (const scene of scenes) {
    await page.evaluate((name) => (location.hash = `#scene=${encodeURIComponent(name)}&time=0`), scene);
    await page.waitForFunction((name) => window.pintle.state().scene === name, scene);
    const first = runs.find((run) => run.scene === scene);
    const times = floats(first.times), poses = floats(first.poses);
    const frame = Math.floor(0.6 * times.length);
    await seek(times[frame]);
    const now = await state();
    assert.ok(Math.abs(now.time - times[frame]) < 1e-3, scene);
    const pane = now.panes[0];
    assert.equal(pane.run, first.name);
    assert.equal(pane.colour, first.colour);
    if (scene.startsWith('cone_rim')) assert.ok(now.options.limits);
    first.bodies.forEach((body, index) => {
      if (body.track === undefined) return;
      const pose = poses.slice(7 * (body.track * times.length + frame));
      const matrix = pane.bodies[index];
      if (!pose.slice(0, 7).every(Number.isFinite)) return assert.equal(matrix, null, `${scene}, body ${index}`);
      const size = 1 + Math.hypot(...pose.slice(0, 3));
      const [x, y, z, w] = pose.slice(3, 7);
      const wanted = [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)];
      for (let i = 0; i < 3; ++i) {
        assert.ok(Math.abs(matrix[12 + i] - pose[i]) < 2e-3 * size, `${scene}, body ${index}: ${matrix[12 + i]} and ${pose[i]}`);
        assert.ok(Math.abs(matrix[i] - wanted[i]) < 0.02, `${scene}, body ${index}, turn`);
      }
    });
    await page.screenshot({path: `${pictures}/${scene}.png`});
    assert.deepEqual(errors, [], scene);
  }
});

test('limits stand where they were recorded, and show how far a joint is beyond', async () => {
  const kinds = new Set();
  const areAngles = (joint) => joint.limits.every(({kind, low, high}) => kind !== 'slide' && kind !== 'distance' && high - low < 6);
  for (const name of ['wedge_sides', 'cone_rim', 'bend_rim', 'hinge_turns', 'ragdoll', 'flat_cone', 'wedge_wide', 'door']) {
    const both = ['stock', 'pintle'].map((who) => runs.find((run) => run.scene === name && run.name === who));
    await page.evaluate((scene) => (location.hash = `#scene=${scene}&time=0.7&pane=stock&pane=pintle`), name);
    await page.waitForFunction((scene) => window.pintle.state().scene === scene, name);
    for (const part of [0.1, 0.3, 0.5, 0.7]) {
      const times = floats(both[0].times), frame = Math.floor(part * times.length);
      await seek(times[frame]);
      const now = await state();
      both.forEach((run, i) => {
        const {limits} = now.panes[i];
        assert.ok(limits.length > 0, `${name}, ${run.name}`);
        limits.forEach(({kind}) => kinds.add(kind));
        const overshoot = run.series.find(({key}) => key === 'overshoot');
        if (!run.joints.every(areAngles)) return;
        const recorded = overshoot === undefined ? 0 : floats(overshoot.values)[frame];
        const drawnNow = Math.max(...limits.map(({beyond}) => beyond));
        assert.ok(Math.abs(drawnNow - recorded) < 2e-3, `${name}, ${run.name}, ${times[frame]} s: ${drawnNow}, recorded ${recorded}`);
      });
    }
  }
  for (const kind of ['angle', 'wedge', 'cone', 'twist', 'bend', 'turn']) assert.ok(kinds.has(kind), kind);
  assert.deepEqual(errors, []);
});

test('gaps are lines from anchor to anchor, and contacts are where they were recorded', async () => {
  await page.goto('about:blank');
  await page.goto(`${small}#scene=chain_heavy&time=0&pane=stock`);
  const run = runs.find((one) => one.scene === 'chain_heavy' && one.name === 'stock'), {times, at} = decoded(run);
  const frame = Math.floor(0.7 * times.length);
  await seek(times[frame]);
  const ends = run.joints.map(({a, b, inA, inB}) => [at(a, frame, inA.slice(0, 3)), at(b, frame, inB.slice(0, 3))]);
  for (const long of [1, 10]) {
    const {gaps} = await drawnIn(0);
    assert.equal(gaps.length, ends.filter(([a, b]) => distance(a, b) > 0.01).length, 'all of them are wide');
    for (const gap of gaps) {
      const middle = centre(gap), length = Math.max(...points(gap).map((point) => 2 * distance(point, middle)));
      const found = ends.find(([a, b]) => distance(middle, a.map((value, i) => value + (long / 2) * (b[i] - value))) < 1e-3);
      assert.ok(found !== undefined, `a line about ${middle}`);
      const thick = 0.02;  // m
      assert.ok(Math.abs(length - long * distance(...found)) < thick, `${length} m, gap ${distance(...found)} m`);
    }
    await page.keyboard.press('g');
    await drawn();
  }

  await page.evaluate(() => (location.hash = '#scene=rope_bridge&time=0&pane=exact'));
  await page.waitForFunction(() => window.pintle.state().scene === 'rope_bridge');
  const bridge = decoded(runs.find((one) => one.scene === 'rope_bridge' && one.name === 'exact'));
  const last = bridge.times.length - 1;
  await seek(bridge.times[last]);
  assert.deepEqual((await drawnIn(0)).contacts, []);
  await page.keyboard.press('c');
  await drawn();
  const {contacts} = await drawnIn(0);
  assert.ok(contacts.length > 3, `${contacts.length} contacts`);
  assert.equal(contacts.length, bridge.contacts(last).length);
  assert.ok(areAmong(contacts.map(centre), bridge.contacts(last)));
  await page.keyboard.press('c');
  assert.deepEqual(errors, []);
});

test('hulls, meshes, compounds and tilted planes are drawn as they are; joints that break are gone', async () => {
  const [run] = runsOf(readFileSync(process.env.PINTLE_SHAPES, 'utf8'));
  const {times, at} = decoded(run);
  await page.goto(`file://${process.env.PINTLE_SHAPES}#scene=shapes&time=0`);
  const frame = 20;  // one joint has broken by then, one has been taken away
  const anchors = async (at) => {
    await seek(times[at]);
    return (await drawnIn(0)).anchors.length;
  };
  assert.equal(await anchors(0), 3);
  assert.equal(await anchors(10), 2);
  assert.equal(await anchors(frame), 1);
  await page.screenshot({path: `${pictures}/shapes.png`});

  assert.match(await page.locator('.pane .note').innerText(), /^1 body not there now$/);
  const {corners, bodies, floors} = await drawnIn(0);
  assert.ok(corners.at(-1).every((value) => value === 0), 'what is gone has no extent');
  assert.ok(corners.at(-2).some((value) => value !== 0));
  const shapeOf = (body) => run.shapes[run.bodies[body].shape];
  const kinds = [];
  bodies.forEach((body, i) => {
    const shape = shapeOf(body);
    kinds.push(shape.kind);
    if (shape.kind !== 'mesh') return;
    const wanted = points(floats(shape.points)).map((point) => at(body, frame, point));
    assert.ok(areAmong(wanted, points(corners[i])) && areAmong(points(corners[i]), wanted), `body ${body}`);
  });
  assert.deepEqual(kinds, ['mesh', 'mesh', 'compound', 'box', 'box', 'box']);
  // As long as its balls reach.
  const middle = at(bodies[2], frame, [0, 0, 0]);
  assert.ok(Math.abs(Math.max(...points(corners[2]).map((point) => distance(point, middle))) - 0.7) < 0.01);

  assert.equal(floors.length, 2);
  [0, 1].forEach((body) => {
    const {normal, constant} = shapeOf(body), origin = at(body, 0, [0, 0, 0]);
    const wanted = at(body, 0, normal).map((value, i) => value - origin[i]), m = floors[body];
    assert.ok(distance(m.slice(8, 11), wanted) < 1e-6, `${m.slice(8, 11)} is not along ${wanted}`);
    const height = m.slice(12, 15).reduce((sum, value, i) => sum + (value - origin[i]) * wanted[i], 0);
    assert.ok(Math.abs(height - constant) < 1e-6, `${height} m`);
  });
  assert.deepEqual(errors, []);
});

test('what is thrown does not make what throws it small', async () => {
  await page.goto(`file://${file}#scene=trebuchet&time=0&pane=exact`);
  await drawn();
  const run = runs.find((one) => one.scene === 'trebuchet' && one.name === 'exact'), {times, at} = decoded(run);
  const reach = (held) => {
    const where = run.bodies.flatMap((body, index) => (body.mass > 0 && run.joints.some(({a, b, alive}) =>
      (a === index || b === index) && alive[0][1] === times.length) === held ? times.map((_, frame) => at(index, frame, [0, 0, 0])) : []));
    return Math.max(...where.map((point) => distance(point, where[0])));
  };
  const {view} = await state(), far = distance(view.slice(0, 3), view.slice(3));
  assert.ok(reach(false) > 5 * reach(true), 'the stone goes far');
  assert.ok(far < 4 * reach(true), `${far} m from a machine of ${reach(true)} m`);
  assert.deepEqual(errors, []);
});

test('the plots have the clock as a cursor, and a click goes there', async () => {
  await page.goto('about:blank');
  await page.setViewportSize({width: 1280, height: 720});
  await page.goto(`${small}#scene=chain_heavy&time=1.2`);
  await drawn();
  const cursor = () => page.evaluate(() => window.pintle.cursorTime('gap'));
  assert.ok(Math.abs((await cursor()) - 1.2) < 0.02, `${await cursor()}`);
  const box = await page.locator('.plot[data-key="gap"] .u-over').boundingBox();
  await page.mouse.click(box.x + 0.7 * box.width, box.y + 20);
  await drawn();
  const {time} = await state();
  assert.ok(Math.abs(time - 0.7 * 5) < 0.05, `${time}`);
  assert.ok(Math.abs((await cursor()) - time) < 0.02);
});

test('names in the legends are not cut, beside four panes', async () => {
  await page.keyboard.press('4');
  await drawn();
  const cut = await page.locator('.legend .name').evaluateAll((names) =>
    names.filter(({scrollWidth, clientWidth}) => scrollWidth > clientWidth).map(({textContent}) => textContent));
  assert.deepEqual(cut, []);
  assert.ok((await page.locator('.plot[data-key="gap"] .name').count()) === 4);
});

test('what is 0 in all of a run is plotted, what a run has not is left out', async () => {
  const plotted = async (scene, key, ...panes) => {
    await page.evaluate((hash) => (location.hash = hash), `#scene=${scene}&time=0.5${panes.map((pane) => `&pane=${pane}`).join('')}`);
    await page.waitForFunction((name) => window.pintle.state().scene === name, scene);
    await drawn();
    return page.locator(`.plot[data-key="${key}"] .value`).evaluateAll((values) =>
      values.map((value) => ['.name', '.number'].map((part) => value.querySelector(part).textContent)));
  };
  for (const scene of ['valve', 'limits_of_turns']) {
    assert.equal(runs.find((run) => run.scene === scene && run.name === 'stock').series.some(({key}) => key === 'total'), false);
    const change = await plotted(scene, 'change', 'stock', 'pintle', 'exact');
    assert.deepEqual(change.map(([name]) => name), ['stock', 'pintle', 'exact']);
    assert.match(change[0][1], /^0 J$/);
  }
  const beyond = await plotted('bend_rim', 'overshoot', 'stock', 'pintle', 'exact');
  assert.deepEqual(beyond.map(([name]) => name), ['stock', 'pintle', 'exact']);
  assert.match(beyond[1][1], /^0°$/);
  // Pintle's joint holds no direction there, and nobody knows the impulses of Bullet's multibody.
  assert.deepEqual((await plotted('bend_rim', 'angleOff', 'stock', 'pintle', 'exact')).map(([name]) => name), ['stock']);
  assert.deepEqual((await plotted('chain_heavy', 'impulse', 'stock', 'multibody')).map(([name]) => name), ['stock']);
  assert.deepEqual(errors, []);
});

test('keys play, step, change panes, speed and options', async () => {
  const press = async (key) => {
    await page.keyboard.press(key);
    await drawn();
    return state();
  };
  const times = floats(runs.find((run) => run.scene === 'chain_heavy').times);
  await press('Home');
  let now = await press('ArrowRight');
  assert.ok(Math.abs(now.time - times[1]) < 1e-4);
  now = await press('Shift+ArrowRight');
  assert.ok(Math.abs(now.time - times[11]) < 1e-4);
  now = await press('ArrowLeft');
  assert.ok(Math.abs(now.time - times[10]) < 1e-4);
  assert.equal((await press('End')).time, times[times.length - 1]);
  await press('Home');
  assert.equal((await press('Space')).playing, true);
  await page.waitForFunction(() => window.pintle.state().time > 0.1);
  assert.equal((await press('Space')).playing, false);
  assert.equal((await press('[')).speed, 0.5);
  assert.equal((await press(']')).speed, 1);
  assert.equal((await press('2')).panes.length, 2);
  assert.equal((await press('4')).panes.length, 4);
  for (const [key, option] of [['j', 'joints'], ['l', 'limits'], ['g', 'magnified'], ['c', 'contacts'], ['h', 'shadows']]) {
    const before = (await state()).options[option];
    assert.equal((await press(key)).options[option], !before, option);
    await press(key);
  }
  const {view} = await state();
  assert.notDeepEqual((await press('a')).view, view);
  assert.notDeepEqual((await press('Shift+D')).view.slice(3), view.slice(3));
  await press('f');
  (await press('?'));
  assert.equal(await page.locator('#keys').evaluate((dialog) => dialog.open), true);
  await press('Escape');
  const scene = (await press('n')).scene;
  assert.equal(scene, 'limits_of_turns');
  assert.equal((await press('p')).scene, 'chain_heavy');
  assert.equal((await press('Escape')).scene, null);
  assert.equal((await press('Enter')).scene, 'chain_heavy');  // the card that it came from
  assert.deepEqual(errors, []);
});

test('a link keeps scene, panes, time and camera', async () => {
  const linked = () => page.waitForFunction(() => {
    const link = new URLSearchParams(location.hash.slice(1)), {time, view} = window.pintle.state();
    const camera = (link.get('camera') ?? '').split(',').map(Number);
    return Math.abs(Number(link.get('time')) - time) < 1e-3 &&
           view.every((value, i) => Math.abs(value - camera[i]) < 1e-2 * (1 + Math.abs(value)));
  });
  await page.keyboard.press('Home');
  await page.keyboard.press('2');
  await page.keyboard.press('Shift+ArrowRight');
  await page.keyboard.press('d');
  const isKept = async () => {
    await linked();
    const was = await state(), link = page.url();
    await page.goto('about:blank');
    await page.goto(link);
    await drawn();
    const now = await state();
    assert.equal(now.scene, was.scene);
    assert.deepEqual(now.panes.map((pane) => pane.run), was.panes.map((pane) => pane.run));
    assert.ok(Math.abs(now.time - was.time) < 1e-3);
    now.view.forEach((value, i) => assert.ok(Math.abs(value - was.view[i]) < 1e-2 * (1 + Math.abs(value)), `${now.view}, ${was.view}`));
  };
  await isKept();
  // Where the camera goes along with what it looks at.
  await page.evaluate(() => (location.hash = '#scene=car&time=0&pane=exact'));
  await page.waitForFunction(() => window.pintle.state().scene === 'car');
  const {view} = await state();
  await page.keyboard.press('End');
  await drawn();
  assert.ok(distance((await state()).view.slice(0, 3), view.slice(0, 3)) > 1);
  await isKept();
  // A link that comes just before the page would write its own.
  await page.evaluate(() => {
    location.hash = '#scene=valve&time=0.5';
    document.getElementById('link').click();
  });
  await page.waitForFunction(() => window.pintle.state().scene === 'valve');
  await page.goto(`${small}#scene=chain_heavy&time=0.2&pane=stock&pane=pintle`);
  await drawn();
});

test('the table compares what is shown, and a point opens its run', async () => {
  await page.click('#tab-table');
  assert.equal(await page.locator('#table thead th').count(), 2);
  await page.click('#tab-tradeoff');
  const points = page.locator('#tradeoff .point');
  assert.ok((await points.count()) >= 4);
  await page.locator('#tradeoff .point[aria-label^="Open multibody"]').press('Enter');
  assert.ok((await state()).panes.some((pane) => pane.run === 'multibody'));
  assert.deepEqual(errors, []);
});

test('the scene stays in sight when the window changes, but for a camera that was moved', async () => {
  const far = async () => {
    const {view} = await state();
    return distance(view.slice(0, 3), view.slice(3));
  };
  const resize = async (width) => {
    await page.setViewportSize({width, height: 720});
    await drawn();
    return far();
  };
  await page.keyboard.press('f');
  const near = await far(), narrow = await resize(900);
  assert.ok(narrow > 1.1 * near, `${near} m, ${narrow} m`);
  assert.ok(Math.abs((await resize(1280)) / near - 1) < 1e-3);
  await page.keyboard.press('q');
  const moved = await far();
  assert.ok(Math.abs((await resize(900)) / moved - 1) < 1e-3);
  await resize(1280);
  await page.keyboard.press('f');
});

test('another run is chosen in a pane, and the mouse turns the camera', async () => {
  const list = page.locator('.pane select').first();
  await list.selectOption({label: 'stock, 50 iterations'});
  assert.equal((await state()).panes[0].run, 'stock, 50 iterations');
  const {view} = await state();
  await page.mouse.move(300, 300);
  await page.mouse.down();
  await page.mouse.move(360, 320);
  await page.mouse.up();
  assert.notDeepEqual((await state()).view, view);
  assert.deepEqual(errors, []);
});

test('damaged recordings are said, and the others are shown', async () => {
  const short = JSON.parse(JSON.stringify(runs.find((run) => run.scene === 'chain')));
  const lost = JSON.parse(JSON.stringify(short));
  const poses = floats(lost.poses);
  poses.fill(NaN, 0, 7);
  lost.poses = Buffer.from(Float32Array.from(poses).buffer).toString('base64');
  short.name = 'short';
  short.poses = short.poses.slice(0, 400);
  const damaged = writePage('damaged', ['{"format": "pintle-run", "ver', '{"format": "something else"}', JSON.stringify(lost), JSON.stringify(short)]);
  await page.close();
  page = await newPage();
  await page.goto(`${damaged}#scene=chain&time=0`);
  await drawn();
  const problems = await page.locator('#problems').innerText();
  assert.match(problems, /Recording 1 can't be read: it is no JSON/);
  assert.match(problems, /Recording 2 can't be read: it is no recording/);
  assert.match(problems, /"short" of "Chain" is damaged: poses have 300 bytes/);
  assert.match(await page.locator('.pane .note').first().innerText(), /1 body not finite: not drawn/);
  assert.equal((await state()).panes.length, 1);
  await page.screenshot({path: `${pictures}/damaged.png`});
  assert.deepEqual(errors, []);
});

test('is read on a phone, in the dark', async () => {
  await page.close();
  page = await newPage({viewport: {width: 390, height: 844}, colorScheme: 'dark', hasTouch: true});
  await page.goto(`${small}#scene=rope_bridge&time=1.5`);
  await drawn();
  assert.equal((await state()).panes.length, 2);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `${wide} px wide`);
  const cut = await page.evaluate(() => ['title', 'subtitle'].filter((id) => {
    const {clientWidth, clientHeight, scrollWidth, scrollHeight} = document.getElementById(id);
    return clientHeight === 0 || scrollWidth > clientWidth || scrollHeight > clientHeight + 1;
  }));
  assert.deepEqual(cut, []);
  await page.screenshot({path: `${pictures}/phone.png`});
  // The clock stays in sight, where the plots are read.
  await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
  await drawn();
  const [play, plots] = await Promise.all(['#play', '#plots'].map((element) => page.locator(element).boundingBox()));
  assert.ok(plots.y < 0 && play.y >= 0 && play.y + play.height < 120, `${play.y}`);
  assert.deepEqual(errors, []);
});
