// The panes' own words over the pictures: which run it is, its gap now, and what can't be drawn.

import {colourOf, isVariant, onBackground} from './colours';
import type {Run, Scene} from './data';
import {formatted, make} from './format';
import type {Pane} from './scene3d';

export interface PaneElements {
  root: HTMLElement;
  list: HTMLSelectElement;
  gap: HTMLElement;
  note: HTMLElement;
}

export function makePane(scene: Scene, run: Run, choose: (run: Run) => void): PaneElements {
  const list = make('select');
  list.title = 'Another run here';
  list.setAttribute('aria-label', 'Run of this pane');
  scene.runs.forEach((one, index) => list.append(new Option(one.name, String(index), one === run, one === run)));
  list.addEventListener('change', () => choose(scene.runs[Number(list.value)]!));
  const gap = make('span', 'gap');
  const note = make('div', 'note');
  note.hidden = true;
  const detail = make('span', 'detail', run.detail);
  const label = make('div', 'label', make('i', isVariant(run) ? 'dot variant' : 'dot'), list, gap);
  // The camera does not follow what is done here.
  for (const event of ['pointerdown', 'wheel']) label.addEventListener(event, (of) => of.stopPropagation());
  const root = make('div', 'pane', label, detail, note);
  root.style.setProperty('--colour', onBackground(colourOf(run, scene.runs.indexOf(run))));
  return {root, list, gap, note};
}

function count(what: string, number: number): string {
  return `${number} ${number === 1 ? what : what === 'body' ? 'bodies' : `${what}s`}`;
}

export function updatePane(elements: PaneElements, pane: Pane, time: number): void {
  const open = pane.run.open();
  const frame = open.frameAt(time);
  const series = open.series.get('gap');
  const text = series === undefined ? '' : `gap ${formatted(series.values[frame], 'm')}`;
  if (elements.gap.textContent !== text) elements.gap.textContent = text;
  const notes: string[] = [];
  if (pane.view.lost.length > 0) notes.push(`${count('body', pane.view.lost.length)} not finite: not drawn`);
  if (pane.view.gone > 0) notes.push(`${count('body', pane.view.gone)} not there now`);
  const note = notes.join('. ');
  if (elements.note.textContent !== note) elements.note.textContent = note;
  elements.note.hidden = note === '';
}
