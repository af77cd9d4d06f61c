// The clock, and what the keyboard does.

import {byId, make, seconds} from './format';

export const speeds = [1 / 8, 1 / 4, 1 / 2, 1, 2, 4];

export interface Actions {
  seek(time: number): void;
  step(frames: number): void;
  fit(): void;
  panes(count: number): void;
  neighbour(step: number): void;
  gallery(): void;
  toggle(option: string): void;
  camera(turn: number, tilt: number, nearer: number, right: number, up: number): void;
}

const keys: [string, string][] = [
  ['Space', 'play or pause'],
  ['← →', 'one step back or on; with Shift ten'],
  ['Home End', 'the start, the end'],
  ['[ ]', 'slower, faster'],
  ['1 2 3 4', 'so many panes'],
  ['W A S D', 'turn the camera; with Shift move it'],
  ['Q E', 'nearer, farther'],
  ['F', 'see all'],
  ['J L C H', 'joints, limits, contacts, shadows'],
  ['G', 'gaps ten times as long'],
  ['P N', 'scene before, next scene'],
  ['Esc', 'all scenes'],
];

export class Controls {
  time = 0;
  playing = false;
  speed = 1;
  duration = 1;
  private last = 0;
  private readonly scrubber = byId<HTMLInputElement>('scrubber');
  private readonly output = byId<HTMLOutputElement>('time');
  private readonly playButton = byId<HTMLButtonElement>('play');
  private readonly speedList = byId<HTMLSelectElement>('speed');
  private readonly dialog = byId<HTMLDialogElement>('keys');

  constructor(private readonly actions: Actions) {
    for (const speed of speeds) {
      const text = speed < 1 ? `1/${1 / speed} ×` : `${speed} ×`;
      this.speedList.append(new Option(text, String(speed), speed === 1, speed === 1));
    }
    this.speedList.addEventListener('change', () => (this.speed = Number(this.speedList.value)));
    this.scrubber.addEventListener('input', () => actions.seek(Number(this.scrubber.value)));
    this.playButton.addEventListener('click', () => this.setPlaying(!this.playing));
    byId('back').addEventListener('click', () => actions.step(-1));
    byId('forward').addEventListener('click', () => actions.step(1));
    byId('fit').addEventListener('click', () => actions.fit());
    byId('previous').addEventListener('click', () => actions.neighbour(-1));
    byId('next').addEventListener('click', () => actions.neighbour(1));
    byId('home').addEventListener('click', () => actions.gallery());
    byId('help').addEventListener('click', () => this.dialog.showModal());
    const list = this.dialog.querySelector('dl')!;
    for (const [key, what] of keys) {
      const term = make('dt');
      for (const one of key.split(' ')) term.append(make('kbd', '', one), ' ');
      list.append(term, make('dd', '', what));
    }
    document.addEventListener('keydown', (event) => this.key(event));
  }

  setDuration(duration: number): void {
    this.duration = duration;
    this.scrubber.max = String(duration);
  }

  setPlaying(playing: boolean): void {
    this.playing = playing;
    // From the start again, where it has ended.
    if (playing && this.time >= this.duration) this.actions.seek(0);
    this.playButton.setAttribute('aria-label', playing ? 'Pause' : 'Play');
    this.playButton.title = playing ? 'Pause (Space)' : 'Play (Space)';
    this.playButton.querySelector('path')!.setAttribute('d', playing ? 'M7 5h3.6v14H7zM13.4 5H17v14h-3.600z' : 'M8 5l11 7-11 7z');
  }

  setTime(time: number): void {
    this.time = Math.min(Math.max(time, 0), this.duration);
  }
  showTime(): void {
    this.scrubber.value = String(this.time);
    this.scrubber.style.setProperty('--part', `${(100 * this.time) / this.duration}%`);
    this.scrubber.setAttribute('aria-valuetext', seconds(this.time));
    this.output.value = `${this.time.toFixed(2)} / ${seconds(this.duration)}`;
  }

  /** The time that the clock has come to. */
  advance(now: number): number {
    const passed = Math.min((now - this.last) / 1000, 0.25);
    this.last = now;
    if (!this.playing) return this.time;
    const time = this.time + this.speed * passed;
    if (time >= this.duration) this.setPlaying(false);
    return time;
  }

  private changeSpeed(step: number): void {
    const at = speeds.indexOf(this.speed) + step;
    this.speed = speeds[Math.min(Math.max(at, 0), speeds.length - 1)]!;
    this.speedList.value = String(this.speed);
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || this.dialog.open) return;
    const target = event.target as HTMLElement;
    const inGallery = byId('player').hidden;
    if (event.key === '?') return this.dialog.showModal();
    if (inGallery || target instanceof HTMLSelectElement) return;
    const onButton = target instanceof HTMLButtonElement && (event.key === ' ' || event.key === 'Enter');
    const onTab = target.getAttribute('role') === 'tab' && event.key.startsWith('Arrow');
    if (onButton || onTab) return;
    const {actions} = this;
    const shift = event.shiftKey;
    const move = (x: number, y: number): void => (shift ? actions.camera(0, 0, 1, 0.05 * x, -0.05 * y) : actions.camera(0.09 * x, 0.07 * y, 1, 0, 0));
    const does: Record<string, () => void> = {
      ' ': () => this.setPlaying(!this.playing),
      ArrowLeft: () => actions.step(shift ? -10 : -1),
      ArrowRight: () => actions.step(shift ? 10 : 1),
      Home: () => actions.seek(0),
      End: () => actions.seek(this.duration),
      '[': () => this.changeSpeed(-1),
      ']': () => this.changeSpeed(1),
      a: () => move(-1, 0),
      d: () => move(1, 0),
      w: () => move(0, -1),
      s: () => move(0, 1),
      q: () => actions.camera(0, 0, 0.9, 0, 0),
      e: () => actions.camera(0, 0, 1 / 0.9, 0, 0),
      f: () => actions.fit(),
      j: () => actions.toggle('joints'),
      l: () => actions.toggle('limits'),
      c: () => actions.toggle('contacts'),
      h: () => actions.toggle('shadows'),
      g: () => actions.toggle('magnified'),
      p: () => actions.neighbour(-1),
      n: () => actions.neighbour(1),
      Escape: () => actions.gallery(),
    };
    for (const count of [1, 2, 3, 4]) does[String(count)] = () => actions.panes(count);
    const act = does[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (act === undefined) return;
    event.preventDefault();
    act();
  }
}
