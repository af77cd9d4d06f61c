// Who recorded a run says its colour (of the gallery, demos/engines/contenders.cpp). Other runs take these by their place
// in the scene: colours of Okabe and Ito, which the colour-blind tell apart.

import type {Run} from './data';

const others = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#7d8590', '#882255'];

export function colourOf(run: Run, index: number): string {
  return run.colour !== '' ? run.colour : others[index % others.length]!;
}

/** A contender with settings of its own has its colour, dashed or as a ring. */
export const isVariant = (run: Run): boolean => /[ ,]/.test(run.name);

export const isDark = (): boolean => {
  const chosen = document.documentElement.dataset['theme'];
  if (chosen !== undefined) return chosen === 'dark';
  return matchMedia('(prefers-color-scheme: dark)').matches;
};

/** As it is drawn on the page's background: lighter where that is dark, so that it can be read. */
export function onBackground(colour: string): string {
  return isDark() ? mix(colour, '#ffffff', 0.28) : colour;
}

export function mix(a: string, b: string, part: number): string {
  const channels = (colour: string): number[] => [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
  const from = channels(a), to = channels(b);
  const mixed = from.map((value, i) => Math.round(value + part * (to[i]! - value)));
  return '#' + mixed.map((value) => value.toString(16).padStart(2, '0')).join('');
}
