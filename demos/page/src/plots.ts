// What was measured over time, of all that is shown, with the clock as a cursor.

import uPlot from 'uplot';

import {colourOf, isDark, isVariant, onBackground} from './colours';
import type {OpenRun, Run, Scene} from './data';
import {formatted, make} from './format';

interface Plot {
  key: string;
  element: HTMLElement;
  plot: uPlot;
  clock: HTMLElement;
  values: {element: HTMLElement; run: OpenRun; data: Float32Array | number[]}[];
  unit: string;
}

type Column = (number | null | undefined)[];

interface Kind {
  key: string;
  label: string;
  log: boolean;
  // Of one run; undefined: it has no such numbers.
  values(run: OpenRun): {values: ArrayLike<number>; unit: string} | undefined;
}

// Angles in degrees.
const raw = (key: string) => (run: OpenRun): {values: ArrayLike<number>; unit: string} | undefined => {
  const series = run.measured(key);
  if (series?.unit !== 'rad') return series;
  return {values: series.values.map((value) => (value * 180) / Math.PI), unit: '°'};
};

const change = (run: OpenRun): {values: ArrayLike<number>; unit: string} | undefined => {
  const total = run.measured('total');
  if (total === undefined) return undefined;
  return {values: total.values.map((value) => value - total.values[0]!), unit: total.unit};
};

const kinds: Kind[] = [
  {key: 'gap', label: 'Gap between anchors', log: true, values: raw('gap')},
  {key: 'angleOff', label: 'Angle off', log: true, values: raw('angleOff')},
  {key: 'overshoot', label: 'Beyond limits', log: true, values: raw('overshoot')},
  {key: 'change', label: 'Energy, change', log: false, values: change},
  {key: 'linear', label: 'Energy of motion', log: false, values: raw('linear')},
  {key: 'angular', label: 'Energy of turning', log: false, values: raw('angular')},
  {key: 'potential', label: 'Energy of height', log: false, values: raw('potential')},
  {key: 'momentum', label: 'Momentum', log: false, values: raw('momentum')},
  {key: 'spin', label: 'Angular momentum', log: false, values: raw('spin')},
  {key: 'impulse', label: 'Largest impulse of a joint', log: true, values: raw('impulse')},
  {key: 'step', label: 'Time of a step', log: true, values: raw('step')},
];

const least = 1e-10;  // of what a logarithm is taken of

export class Plots {
  private plots: Plot[] = [];
  private shown: OpenRun[] = [];
  private time = 0;
  private readonly resize: ResizeObserver;

  constructor(private readonly element: HTMLElement, private readonly seek: (time: number) => void) {
    this.resize = new ResizeObserver(() => {
      for (const {plot, element: box} of this.plots) plot.setSize({width: box.clientWidth, height: plot.height});
    });
    this.resize.observe(element);
  }

  show(scene: Scene, runs: Run[], time: number): void {
    for (const {plot} of this.plots) plot.destroy();
    this.plots = [];
    this.element.replaceChildren();
    this.shown = runs.map((run) => run.open());
    for (const kind of kinds) {
      const found = this.shown.flatMap((run) => {
        const series = kind.values(run);
        return series === undefined ? [] : [{run, ...series}];
      });
      // What is nothing in all runs, but for rounding, is left out.
      if (Math.max(0, ...found.map(({values}) => largest(values))) > 1e-9) this.add(kind, scene, found);
    }
    this.time = time;
  }

  private add(kind: Kind, scene: Scene, found: {run: OpenRun; values: ArrayLike<number>; unit: string}[]): void {
    const unit = found.find((one) => one.unit !== '')!.unit;
    const legend = make('span', 'legend');
    const head = make('div', 'plot-head', make('h3', '', kind.label), legend);
    const box = make('div', 'plot-box');
    const section = make('section', 'plot', head, box);
    section.dataset['key'] = kind.key;
    this.element.append(section);

    // One list of times for all: runs may have frames of their own.
    const times = [...new Set(found.flatMap(({run}) => Array.from(run.times)))].sort((a, b) => a - b);
    const place = new Map(times.map((time, i) => [time, i]));
    const columns: Column[] = found.map(({run, values}) => {
      const column: Column = new Array(times.length).fill(undefined);
      run.times.forEach((time, i) => {
        const value = values[i]!;
        column[place.get(time)!] = !Number.isFinite(value) ? null : kind.log ? Math.max(Math.abs(value), least) : value;
      });
      return column;
    });
    const range = logRange(columns);
    // What is less than all that is drawn lies at the lower edge.
    if (kind.log) for (const column of columns) column.forEach((value, i) => typeof value === 'number' && (column[i] = Math.max(value, range[0])));
    const ink = isDark() ? '#9aa5b1' : '#5c6773', grid = isDark() ? '#2c333c' : '#e4e8ed';
    const font = '11px system-ui, sans-serif';
    const axis: uPlot.Axis = {stroke: ink, font, grid: {stroke: grid, width: 1}, ticks: {stroke: grid, width: 1, size: 3}};
    const plot = new uPlot({
      width: Math.max(box.clientWidth, 100),
      height: 124,
      padding: [8, 10, 0, 0],
      legend: {show: false},
      cursor: {drag: {x: false, y: false}, points: {size: 5}},
      scales: {x: {time: false, range: [times[0]!, Math.max(times[times.length - 1]!, times[0]! + 1e-6)]},
               y: kind.log ? {distr: 3, range} : {}},
      hooks: {draw: [() => this.setTime(this.time)]},  // where its parts are is known then
      axes: [
        {...axis, size: 22, gap: 2, values: (_, splits) => splits.map((value) => `${Number(value.toPrecision(6))}`)},
        {...axis, size: axisSize, gap: 3, space: 24, ...(kind.log ? {splits: powers, filter: (_, splits) => splits} : {}),
         values: (_, splits) => splits.map((value) => formatted(value, unit))},
      ],
      series: [{}, ...found.map(({run}) => ({
        stroke: onBackground(colourOf(run.run, scene.runs.indexOf(run.run))),
        width: 1.6,
        ...(isVariant(run.run) ? {dash: [5, 3]} : {}),
        spanGaps: false,
        points: {show: false},
      }))],
    }, [times, ...columns] as uPlot.AlignedData, box);
    const clock = make('div', 'clock');
    plot.over.append(clock);
    plot.over.addEventListener('click', (event) => {
      const left = event.clientX - plot.over.getBoundingClientRect().left;
      this.seek(plot.posToVal(left, 'x'));
    });
    const values = found.map(({run, values: data}) => {
      const element = make('span', 'number');
      const entry = make('span', 'value', make('span', 'name', run.run.name.replace(/, (\d+) iterations$/, ' $1')), element);
      entry.style.setProperty('--colour', onBackground(colourOf(run.run, scene.runs.indexOf(run.run))));
      entry.classList.toggle('variant', isVariant(run.run));
      entry.title = run.run.name;
      legend.append(entry);
      return {element, run, data: data as Float32Array};
    });
    this.plots.push({key: kind.key, element: box, plot, clock, values, unit});
  }

  setTime(time: number): void {
    this.time = time;
    for (const {plot, clock, values, unit} of this.plots) {
      const left = plot.valToPos(time, 'x');
      if (Number.isFinite(left)) clock.style.transform = `translateX(${left.toFixed(2)}px)`;
      for (const {element, run, data} of values) {
        const text = formatted(data[run.frameAt(time)], unit);
        if (element.textContent !== text) element.textContent = text;
      }
    }
  }

  /** Where the cursor of a plot is: the time that it points to. For tests. */
  cursorTime(key: string): number {
    const of = this.plots.find((plot) => plot.key === key)!;
    return of.plot.posToVal(new DOMMatrix(of.clock.style.transform).m41, 'x');
  }
}

function largest(values: ArrayLike<number>): number {
  let most = 0;
  for (let i = 0; i < values.length; ++i) most = Math.max(most, Number.isFinite(values[i]!) ? Math.abs(values[i]!) : 1);
  return most;
}

// As wide as the labels need; mostly the same, so that the plots are one below the other.
function axisSize(plot: uPlot, labels: string[] | null, axis: number): number {
  const usual = 58, besides = 8;  // px; the tick, and what is between it and its label
  plot.ctx.save();
  plot.ctx.font = (plot.axes[axis]!.font as unknown as string[])[0]!;  // in pixels of the canvas
  const widest = Math.max(0, ...(labels ?? []).map((label) => plot.ctx.measureText(label ?? '').width)) / devicePixelRatio;
  plot.ctx.restore();
  return Math.max(usual, Math.ceil(widest) + besides);
}

// Whole powers of ten, at most five.
function powers(_: uPlot, __: number, low: number, high: number): number[] {
  const from = Math.round(Math.log10(low)), to = Math.round(Math.log10(high));
  const stride = Math.max(1, Math.ceil((to - from) / 4));
  const all: number[] = [];
  for (let power = from; power <= to; power += stride) all.push(Number(`1e${power}`));
  return all;
}

// Whole powers of ten about what there is, but not those of rounding alone.
function logRange(columns: Column[]): [number, number] {
  const all = columns.flat().filter((value): value is number => typeof value === 'number' && value > least);
  if (all.length === 0) return [1e-9, 1];
  all.sort((a, b) => a - b);
  const low = all[Math.floor(0.02 * all.length)]!, high = all[all.length - 1]!;
  return [10 ** Math.floor(Math.log10(low)), 10 ** Math.ceil(Math.log10(high) + 1e-9)];
}
