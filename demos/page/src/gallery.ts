// All scenes as cards, in their groups, each with a picture of its best run.

import {colourOf, isVariant, onBackground} from './colours';
import type {Page, Scene} from './data';
import {make} from './format';

export class Gallery {
  private readonly waiting: {scene: Scene; canvas: HTMLCanvasElement}[] = [];
  private busy = false;

  constructor(private readonly element: HTMLElement, private readonly page: Page,
              private readonly open: (scene: Scene) => void,
              private readonly picture: (scene: Scene, to: HTMLCanvasElement) => void) {
    const groups = new Map<string, Scene[]>();
    for (const scene of page.scenes) groups.set(scene.group, [...(groups.get(scene.group) ?? []), scene]);
    const seen = new IntersectionObserver((entries) => {
      for (const entry of entries) {
        if (!entry.isIntersecting) continue;
        seen.unobserve(entry.target);
        const canvas = entry.target as HTMLCanvasElement;
        this.waiting.push({scene: this.page.scenes[Number(canvas.dataset['scene'])]!, canvas});
      }
      this.work();
    }, {rootMargin: '200px'});
    for (const [group, scenes] of groups) {
      const grid = make('div', 'cards');
      for (const scene of scenes) grid.append(this.card(scene, seen));
      const section = make('section', 'group');
      if (group !== '') section.append(make('h2', '', group));
      section.append(grid);
      this.element.append(section);
    }
    if (page.scenes.length === 0)
      this.element.append(make('p', 'hint', 'There is no recording in this page.'));
  }

  private card(scene: Scene, seen: IntersectionObserver): HTMLElement {
    const canvas = make('canvas');
    canvas.width = 480;
    canvas.height = 300;
    canvas.dataset['scene'] = String(this.page.scenes.indexOf(scene));
    seen.observe(canvas);
    const dots = make('span', 'dots');
    scene.runs.slice(0, 8).forEach((run, index) => {
      if (isVariant(run)) return;
      const dot = make('i');
      dot.style.background = onBackground(colourOf(run, index));
      dot.title = run.name;
      dots.append(dot);
    });
    const card = make('button', 'card', make('div', 'picture', canvas),
                      make('div', 'words', make('h3', '', scene.title), make('p', '', scene.text), dots));
    card.type = 'button';
    card.dataset['scene'] = scene.name;
    card.addEventListener('click', () => this.open(scene));
    return card;
  }

  // One picture at a time, while nothing else is to be done.
  private work(): void {
    if (this.busy || this.waiting.length === 0) return;
    this.busy = true;
    const later = window.requestIdleCallback ?? ((run: () => void) => setTimeout(run, 30));
    later(() => {
      this.busy = false;
      if (this.element.hidden) return;
      const next = this.waiting.shift();
      if (next !== undefined) {
        this.picture(next.scene, next.canvas);
        next.canvas.classList.add('drawn');
      }
      this.work();
    });
  }

  show(): void {
    this.element.hidden = false;
    this.work();
  }
  hide(): void {
    this.element.hidden = true;
  }
  /** In other colours. */
  redraw(): void {
    this.element.querySelectorAll<HTMLCanvasElement>('canvas.drawn').forEach((canvas) =>
      this.waiting.push({scene: this.page.scenes[Number(canvas.dataset['scene'])]!, canvas}));
    if (!this.element.hidden) this.work();
  }
}
