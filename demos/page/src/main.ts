// The page: what is shown, and who is told of it.

import {colourOf, isVariant, onBackground} from './colours';
import {showTable, showTradeOff} from './compare';
import {Controls} from './controls';
import {DataError, readPage, type Run, type Scene} from './data';
import {byId, make} from './format';
import {Gallery} from './gallery';
import {readLink, writeLink} from './link';
import {makePane, updatePane, type PaneElements} from './panes';
import {Plots} from './plots';
import {Stage, type Pane} from './scene3d';
import type {ViewOptions} from './view3d';

type Tab = 'plots' | 'table' | 'tradeoff';

class App {
  private readonly page = readPage(document);
  private readonly stage: Stage;
  private readonly controls: Controls;
  private readonly plots: Plots;
  private readonly gallery: Gallery;
  private readonly options: ViewOptions = {joints: true, limits: false, magnified: false, contacts: false, shadows: true};
  private scene: Scene | null = null;
  private shown: Run[] = [];
  private elements: {pane: Pane; own: PaneElements}[] = [];
  private limitsChosen = false;  // by the user; else they are drawn where they are few
  private stale = true;  // something is to be drawn
  private tab: Tab = 'plots';
  private linkTimer = 0;
  private link = location.hash;  // as the page last read or wrote it
  private said = 0;      // ms: when the words were last brought up to date
  private saidTime = 0;  // s: and to which time

  constructor() {
    performance.mark('read');
    this.stage = new Stage(byId('panes'), byId<HTMLCanvasElement>('canvas'), () => this.changed());
    performance.mark('stage');
    this.plots = new Plots(byId('plots'), (time) => this.seek(time));
    this.controls = new Controls({
      seek: (time) => this.seek(time),
      step: (frames) => this.step(frames),
      fit: () => this.stage.fit(),
      panes: (count) => this.setCount(count),
      neighbour: (step) => this.neighbour(step),
      gallery: () => this.showGallery(),
      toggle: (option) => this.toggle(option as keyof ViewOptions),
      camera: (...by) => this.stage.move(...by),
    });
    this.gallery = new Gallery(byId('gallery'), this.page, (scene) => this.open(scene), (scene, to) => {
      try {
        this.stage.picture(scene, best(scene), to);
      } catch (error) {
        this.damaged(error, best(scene));
      }
      this.stale = true;
    });
    this.listen();
    this.sayProblems();
    this.follow(true);
    requestAnimationFrame((now) => {
      this.frame(now);
      requestAnimationFrame(() => performance.mark('shown'));  // what was drawn is seen now
    });
  }

  private listen(): void {
    document.querySelectorAll<HTMLButtonElement>('[data-option]').forEach((button) =>
      button.addEventListener('click', () => this.toggle(button.dataset['option'] as keyof ViewOptions)));
    for (const tab of ['plots', 'table', 'tradeoff'] as const) {
      const button = byId(`tab-${tab}`);
      button.addEventListener('click', () => this.setTab(tab));
      button.addEventListener('keydown', (event) => {
        const step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
        if (step === 0) return;
        const all: Tab[] = ['plots', 'table', 'tradeoff'];
        const next = all[(all.indexOf(tab) + step + 3) % 3]!;
        this.setTab(next);
        byId(`tab-${next}`).focus();
      });
    }
    byId('theme').addEventListener('click', () => {
      const root = document.documentElement;
      const dark = root.dataset['theme'] === undefined ? matchMedia('(prefers-color-scheme: dark)').matches : root.dataset['theme'] === 'dark';
      root.dataset['theme'] = dark ? 'light' : 'dark';
      this.recolour();
    });
    byId('link').addEventListener('click', () => {
      this.writeLink();
      void navigator.clipboard?.writeText(location.href).then(() => this.say('The link is copied.'), () => this.say('The link is in the address bar.'));
    });
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.recolour());
    addEventListener('resize', () => {
      this.stage.resize();
      this.changed();
    });
    addEventListener('hashchange', () => this.follow(false));
    this.setToggles();
  }

  // --- what is shown ---------------------------------------------------------------------------------

  private open(scene: Scene, panes: string[] = [], time = 0, view: number[] | null = null): void {
    const named = panes.map((name) => scene.runs.find((run) => run.name === name)).filter((run): run is Run => run !== undefined);
    try {
      this.stage.setScene(scene);
    } catch (error) {
      this.damaged(error, scene.runs[0]!);
      return;
    }
    this.scene = scene;
    byId('title').textContent = scene.title;
    byId('subtitle').textContent = scene.text;
    document.title = `${scene.title} – Pintle`;
    this.gallery.hide();
    for (const id of ['heading', 'player', 'link']) byId(id).hidden = false;
    for (const id of ['previous', 'next']) byId(id).hidden = this.page.scenes.length < 2;
    this.setRuns(named.length > 0 ? named : usual(scene));
    if (this.scene === null) return;
    this.seek(time);
    this.stage.follow(this.controls.time);  // a link's camera is where it was at that time
    this.stage.fit();
    if (view !== null) this.stage.view = view;
    else if (time === 0 && !matchMedia('(prefers-reduced-motion: reduce)').matches) this.controls.setPlaying(true);
    if (document.activeElement === document.body || byId('gallery').contains(document.activeElement)) byId('play').focus();
  }

  private setRuns(runs: Run[]): void {
    const scene = this.scene!;
    const holder = byId('panes');
    this.stage.clear();
    this.elements = [];
    this.shown = [];
    const children: HTMLElement[] = [];
    runs.slice(0, 4).forEach((run, place) => {
      const own = makePane(scene, run, (chosen) => this.setRuns(this.shown.map((old, i) => (i === place ? chosen : old))));
      children.push(own.root);
      try {
        this.elements.push({pane: this.stage.addPane(run, scene.runs.indexOf(run), own.root), own});
        this.shown.push(run);
      } catch (error) {
        own.note.hidden = false;
        own.note.textContent = this.damaged(error, run);
      }
    });
    holder.replaceChildren(...children);
    holder.dataset['count'] = String(children.length);
    if (!this.limitsChosen) this.options.limits = this.elements.every(({pane}) => pane.view.joints.hasFewLimits);
    this.setToggles();
    const longest = Math.max(0, ...this.shown.map((run) => run.open().duration));
    this.controls.setDuration(Math.max(longest, 1e-3));
    this.fillCounts(children.length);
    this.fillSide();
    this.changed();
  }

  private setCount(count: number): void {
    if (this.scene === null) return;
    const rest = [...usual(this.scene, 4), ...this.scene.runs].filter((run) => !this.shown.includes(run));
    this.setRuns([...new Set([...this.shown, ...rest])].slice(0, count));
    this.stage.fit();
  }

  private fillCounts(count: number): void {
    const most = Math.min(4, this.scene!.runs.length);
    byId('counts').replaceChildren(...[1, 2, 3, 4].slice(0, most).map((number) => {
      const button = make('button', '', String(number));
      button.type = 'button';
      button.title = `${number} ${number === 1 ? 'pane' : 'panes'} (${number})`;
      button.setAttribute('aria-pressed', String(number === count));
      button.addEventListener('click', () => this.setCount(number));
      return button;
    }));
  }

  private fillSide(): void {
    const scene = this.scene!;
    for (const tab of ['plots', 'table', 'tradeoff'] as const) {
      byId(tab).hidden = tab !== this.tab;
      byId(`tab-${tab}`).setAttribute('aria-selected', String(tab === this.tab));
      byId(`tab-${tab}`).tabIndex = tab === this.tab ? 0 : -1;
    }
    if (this.tab === 'plots') this.plots.show(scene, this.shown, this.controls.time);
    if (this.tab === 'table') showTable(byId('table'), scene, this.shown);
    if (this.tab === 'tradeoff') {
      try {
        showTradeOff(byId('tradeoff'), scene, this.shown, (run) => this.bring(run));
      } catch (error) {
        byId('tradeoff').textContent = this.damaged(error, scene.runs[0]!);
      }
    }
  }

  // A run that is not shown takes the last pane, or one of its own while there is room.
  private bring(run: Run): void {
    if (this.shown.includes(run)) return;
    this.setRuns([...(this.shown.length < 4 ? this.shown : this.shown.slice(0, 3)), run]);
    this.stage.fit();
  }

  private setTab(tab: Tab): void {
    this.tab = tab;
    if (this.scene !== null) this.fillSide();
  }

  private showGallery(): void {
    this.controls.setPlaying(false);
    const last = this.scene?.name;
    this.scene = null;
    for (const id of ['heading', 'player', 'link', 'previous', 'next']) byId(id).hidden = true;
    document.title = 'Pintle';
    this.replaceLink(location.pathname + location.search);
    this.gallery.show();
    if (last !== undefined) document.querySelector<HTMLElement>(`.card[data-scene="${CSS.escape(last)}"]`)?.focus();
  }

  private neighbour(step: number): void {
    if (this.scene === null) return;
    const {scenes} = this.page;
    this.open(scenes[(scenes.indexOf(this.scene) + step + scenes.length) % scenes.length]!);
  }

  private toggle(option: keyof ViewOptions): void {
    this.options[option] = !this.options[option];
    this.limitsChosen ||= option === 'limits';
    this.setToggles();
    this.changed();
  }
  private setToggles(): void {
    document.querySelectorAll<HTMLButtonElement>('[data-option]').forEach((button) =>
      button.setAttribute('aria-pressed', String(this.options[button.dataset['option'] as keyof ViewOptions])));
  }

  private recolour(): void {
    this.gallery.redraw();
    if (this.scene === null) return;
    const scene = this.scene;
    this.stage.setTheme((run) => scene.runs.indexOf(run));
    for (const {pane, own} of this.elements)
      own.root.style.setProperty('--colour', onBackground(colourOf(pane.run, scene.runs.indexOf(pane.run))));
    this.fillSide();
    this.changed();
  }

  // --- the clock -------------------------------------------------------------------------------------

  private seek(time: number): void {
    this.controls.setTime(time);
    // Where a processor draws, words that change cost as much as the scene.
    const now = performance.now(), often = this.controls.playing && this.stage.plain;
    if (!often || now - this.said > 120) this.sayTime(now);
    this.changed();
  }

  private sayTime(now: number): void {
    this.said = now;
    this.saidTime = this.controls.time;
    this.controls.showTime();
    this.plots.setTime(this.controls.time);
    for (const {pane, own} of this.elements) updatePane(own, pane, this.controls.time);
  }

  private step(frames: number): void {
    this.controls.setPlaying(false);
    const run = this.shown[0]?.open();
    if (run === undefined) return;
    const at = run.frameAt(this.controls.time);
    const next = Math.min(Math.max(at + frames, 0), run.times.length - 1);
    this.seek(run.times[next]!);
  }

  private frame(now: number): void {
    requestAnimationFrame((next) => this.frame(next));
    const time = this.controls.advance(now);
    if (this.scene === null) return;
    if (time !== this.controls.time) this.seek(time);
    if (this.controls.playing) this.stage.count(now);
    else this.stage.pauseCount();
    if (!this.controls.playing && this.saidTime !== this.controls.time) this.stale = true;
    if (!this.stale) return;
    this.stale = false;
    this.stage.draw(this.controls.time, this.options);
    if (!this.controls.playing) this.sayTime(now);
    const rate = this.controls.playing && this.stage.framesPerSecond > 0 ? `${this.stage.framesPerSecond.toFixed(0)} fps` : '';
    if (byId('rate').textContent !== rate) byId('rate').textContent = rate;
  }

  private changed(): void {
    this.stale = true;
    if (this.controls?.playing || this.linkTimer !== 0) return;
    this.linkTimer = window.setTimeout(() => {
      this.linkTimer = 0;
      if (this.stale) this.changed();  // the camera may go on with what it looks at when that is drawn
      else this.writeLink();
    }, 250);
  }

  // --- links and messages ----------------------------------------------------------------------------

  private writeLink(): void {
    // Another link is in the address bar already, and the browser is about to say so.
    if (this.scene === null || location.hash !== this.link) return;
    this.replaceLink(writeLink({
      scene: this.scene.name,
      panes: this.shown.map((run) => run.name),
      time: this.controls.time,
      view: this.stage.view,
    }));
  }
  private replaceLink(link: string): void {
    history.replaceState(null, '', link);
    this.link = location.hash;
  }

  private follow(first: boolean): void {
    this.link = location.hash;
    const link = readLink(location.hash);
    const scene = this.page.scenes.find((one) => one.name === link.scene);
    if (scene !== undefined) this.open(scene, link.panes, link.time, link.view);
    else if (first && this.page.scenes.length === 1) this.open(this.page.scenes[0]!);
    else this.showGallery();
    if (link.scene !== null && scene === undefined) this.say(`There is no scene "${link.scene}" in this page.`);
  }

  private damaged(error: unknown, run: Run): string {
    if (!(error instanceof DataError)) throw error;
    const text = `The recording "${run.name}" of "${run.title}" is damaged: ${error.message}.`;
    if (!this.page.problems.includes(text)) this.page.problems.push(text);
    this.sayProblems();
    return text;
  }

  private sayProblems(): void {
    const element = byId('problems');
    element.hidden = this.page.problems.length === 0;
    element.replaceChildren(...this.page.problems.map((problem) => make('p', '', problem)));
  }

  private say(text: string): void {
    const toast = byId('toast');
    toast.textContent = text;
    toast.classList.add('shown');
    setTimeout(() => toast.classList.remove('shown'), 2500);
  }

  // For tests: what is drawn, as it is drawn.
  state(): unknown {
    return {
      scene: this.scene?.name ?? null,
      scenes: this.page.scenes.map((scene) => ({name: scene.name, runs: scene.runs.map((run) => run.name)})),
      time: this.controls.time,
      playing: this.controls.playing,
      speed: this.controls.speed,
      options: {...this.options},
      framesPerSecond: this.stage.framesPerSecond,
      view: this.stage.view,
      panes: this.elements.map(({pane, own: {root}}) => ({
        run: pane.run.name,
        colour: getComputedStyle(root).getPropertyValue('--colour'),
        bodies: pane.run.open().bodies.map((_, body) => pane.view.matrixOf(body)?.toArray() ?? null),
        limits: pane.view.joints.shownLimits((body) => pane.view.matrixOf(body)),
      })),
    };
  }
  drawn(pane: number): unknown {
    return this.elements[pane]!.pane.view.drawnNow();
  }
  cursorTime(key: string): number {
    return this.plots.cursorTime(key);
  }
}

// What a gallery shows: the run that holds best.
function best(scene: Scene): Run {
  return scene.runs.find((run) => run.name === 'exact') ?? scene.runs[0]!;
}

// Contenders with their own settings, each once, before those with others.
function usual(scene: Scene, most = matchMedia('(max-width: 800px)').matches ? 2 : 4): Run[] {
  const plain = scene.runs.filter((run) => !isVariant(run));
  const all = [...plain, ...scene.runs.filter((run) => !plain.includes(run))];
  if (most > 2) return all.slice(0, most);
  const first = all[0]!, other = all.find((run) => run.name === 'exact') ?? all[1];
  return other === undefined || other === first ? [first] : [first, other];
}

try {
  Object.assign(window, {pintle: new App()});
} catch (error) {
  const problems = byId('problems');
  problems.hidden = false;
  problems.textContent = `The page can't be shown: ${error instanceof Error ? error.message : String(error)}. It needs a browser with WebGL 2.`;
  throw error;
}
