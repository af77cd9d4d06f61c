// The numbers of the runs of a scene: a table of what is shown, and error against run time of all.

import {colourOf, onBackground} from './colours';
import type {Run, Scene} from './data';
import {formatted, make, trimmed} from './format';

interface Row {
  label: string;
  unit: string;
  values: (number | null | undefined)[];
}

function statistics(values: ArrayLike<number> | undefined): {mean: number; most: number} | undefined {
  if (values === undefined) return undefined;
  let sum = 0, most = 0, count = 0;
  for (let i = 0; i < values.length; ++i) {
    if (Number.isNaN(values[i]!)) continue;
    sum += Math.abs(values[i]!);
    most = Math.max(most, Math.abs(values[i]!));
    ++count;
  }
  return count > 0 ? {mean: sum / count, most} : undefined;
}

function rows(runs: Run[]): Row[] {
  const all: Row[] = [];
  const add = (label: string, unit: string, value: (run: Run) => number | null | undefined): void => {
    // What the program has measured in each step is better than what is seen of the frames.
    if (all.some((row) => row.label.startsWith(label))) return;
    const values = runs.map(value);
    if (values.some((one) => one !== undefined)) all.push({label, unit, values});
  };
  const names = new Map(runs.flatMap((run) => run.figures.map((figure) => [figure.name, figure.unit])));
  for (const [name, unit] of names) add(name, unit, (run) => run.figure(name)?.value);
  const series = (run: Run, key: string): {mean: number; most: number} | undefined =>
    runs.some((one) => one.open().series.has(key)) ? statistics(run.open().measured(key)?.values) : undefined;
  add('gap, mean', 'm', (run) => series(run, 'gap')?.mean);
  add('gap, largest', 'm', (run) => series(run, 'gap')?.most);
  add('angle off, largest', 'rad', (run) => series(run, 'angleOff')?.most);
  add('beyond a limit, most', 'rad', (run) => series(run, 'overshoot')?.most);
  add('energy at the end, change', 'J', (run) => {
    const total = run.open().measured('total')?.values;
    return total === undefined ? undefined : total[total.length - 1]! - total[0]!;
  });
  add('impulse of a joint, largest', 'N s', (run) => series(run, 'impulse')?.most);
  add('time of a step', 'us', (run) => series(run, 'step')?.mean);
  return all;
}

export function showTable(element: HTMLElement, scene: Scene, runs: Run[]): void {
  const header = make('tr', '', make('td'));
  for (const run of runs) {
    const cell = make('th', 'run', run.name);
    cell.scope = 'col';
    cell.style.setProperty('--colour', onBackground(colourOf(run, scene.runs.indexOf(run))));
    header.append(cell);
  }
  const body = make('tbody');
  for (const row of rows(runs)) {
    const label = make('th', '', row.label);
    label.scope = 'row';
    const line = make('tr', '', label);
    const finite = row.values.filter((value): value is number => typeof value === 'number' && Number.isFinite(value));
    const least = Math.min(...finite.map(Math.abs));
    for (const value of row.values) {
      const cell = make('td', '', value === undefined ? '–' : formatted(value, row.unit));
      // Only what differs is worth a word.
      if (typeof value === 'number' && runs.length > 1 && Math.abs(value) === least && finite.some((v) => Math.abs(v) > 1.02 * least))
        cell.classList.add('best');
      if (value === null) cell.classList.add('lost');
      line.append(cell);
    }
    body.append(line);
  }
  element.replaceChildren(make('table', '', make('thead', '', header), body));
}

interface Point {
  run: Run;
  x: number;  // us
  y: number;
}

/** Error against the time of a step, a point a run; a click opens it. */
export function showTradeOff(element: HTMLElement, scene: Scene, shown: Run[], open: (run: Run) => void): void {
  const error = scene.runs.map((run) => run.figures[0]).find((figure) => figure !== undefined && figure.unit !== 'us');
  const points: Point[] = [];
  const lost: Run[] = [];
  for (const run of scene.runs) {
    const gap = statistics(run.open().series.get('gap')?.values)?.mean;
    const y = error !== undefined ? run.figure(error.name)?.value : gap;
    const x = run.figure('time of a step')?.value ?? statistics(run.open().series.get('step')?.values)?.mean;
    if (typeof x !== 'number' || !(x > 0)) continue;
    if (typeof y !== 'number' || !Number.isFinite(y)) lost.push(run);
    else points.push({run, x, y: Math.max(Math.abs(y), 1e-12)});
  }
  if (points.length < 2) {
    element.replaceChildren(make('p', 'hint', 'No run of this scene has a time of its steps and an error to show.'));
    return;
  }
  const width = 360, height = 250, left = 56, right = 14, top = 14, bottom = 36;
  const scaleOf = (values: number[], from: number, to: number): {at: (v: number) => number; low: number; high: number} => {
    const low = Math.min(...values) / 1.6, high = Math.max(...values) * 1.6;
    const span = Math.log10(high / low);
    return {at: (v) => from + (Math.log10(v / low) / span) * (to - from), low, high};
  };
  const x = scaleOf(points.map((point) => point.x), left, width - right);
  const y = scaleOf(points.map((point) => point.y), height - bottom, top);
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  svg.setAttribute('role', 'group');
  svg.setAttribute('aria-label', 'Error against the time of a step');
  const draw = (tag: string, attributes: Record<string, string | number>, text = ''): SVGElement => {
    const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
    if (text !== '') made.textContent = text;
    svg.append(made);
    return made;
  };
  const ticks = (low: number, high: number): number[] => {
    const all: number[] = [];
    const few = Math.log10(high / low) < 1.5 ? [1, 2, 5] : [1];
    const stride = Math.ceil(Math.log10(high / low) / 7);
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += stride)
      for (const digit of few) all.push(digit * 10 ** power);
    return all.filter((tick) => tick >= low && tick <= high);
  };
  for (const tick of ticks(x.low, x.high)) {
    draw('line', {class: 'grid', x1: x.at(tick), x2: x.at(tick), y1: top, y2: height - bottom});
    draw('text', {x: x.at(tick), y: height - bottom + 14, 'text-anchor': 'middle'}, formatted(tick, 'us'));
  }
  const unit = error?.unit ?? 'm';
  for (const tick of ticks(y.low, y.high)) {
    draw('line', {class: 'grid', x1: left, x2: width - right, y1: y.at(tick), y2: y.at(tick)});
    draw('text', {x: left - 5, y: y.at(tick) + 4, 'text-anchor': 'end'}, formatted(tick, unit));
  }
  draw('text', {x: (left + width - right) / 2, y: height - 4, 'text-anchor': 'middle', class: 'title'}, 'time of a step (less is better)');
  let lowest = -Infinity;  // the label drawn last
  for (const {run, x: time, y: value} of points.sort((a, b) => b.y - a.y)) {
    lowest = Math.max(lowest + 13, y.at(value));
    const colour = onBackground(colourOf(run, scene.runs.indexOf(run)));
    const group = draw('g', {tabindex: 0, role: 'button', class: shown.includes(run) ? 'point shown' : 'point'});
    const label = `${run.name}: ${formatted(value, unit)}, ${formatted(time, 'us')} a step`;
    group.setAttribute('aria-label', `Open ${label}`);
    group.append(Object.assign(document.createElementNS('http://www.w3.org/2000/svg', 'title'), {textContent: label}));
    const circle = document.createElementNS('http://www.w3.org/2000/svg', 'circle');
    for (const [name, number] of [['cx', x.at(time)], ['cy', y.at(value)], ['r', 6.5]] as const) circle.setAttribute(name, String(number));
    circle.style.fill = colour;
    const text = document.createElementNS('http://www.w3.org/2000/svg', 'text');
    const isRight = x.at(time) > width - 110;
    text.setAttribute('x', String(x.at(time) + (isRight ? -10 : 10)));
    text.setAttribute('y', String(lowest + 4));
    text.setAttribute('text-anchor', isRight ? 'end' : 'start');
    text.textContent = run.name;
    group.append(circle, text);
    group.addEventListener('click', () => open(run));
    group.addEventListener('keydown', (event) => {
      if (event.key !== 'Enter' && event.key !== ' ') return;
      event.preventDefault();
      event.stopPropagation();
      open(run);
    });
  }
  const title = error === undefined ? 'Mean gap' : `${error.name[0]!.toUpperCase()}${error.name.slice(1)}`;
  element.replaceChildren(make('h3', '', `${title} against run time`), svg);
  if (lost.length > 0) element.append(make('p', 'hint', `Lost, and not in the picture: ${lost.map((run) => run.name).join(', ')}.`));
  element.append(make('p', 'hint', `${trimmed(points.length)} runs. Open one by a click or with Enter; filled ones are shown.`));
}
