// What a link keeps, in the URL's fragment: scene, panes, time, camera.

export interface Link {
  scene: string | null;
  panes: string[];
  time: number;
  view: number[] | null;
}

export function readLink(fragment: string): Link {
  const values = new URLSearchParams(fragment.replace(/^#/, ''));
  const view = (values.get('camera') ?? '').split(',').map(Number);
  const time = Number(values.get('time') ?? 0);
  return {
    scene: values.get('scene'),
    panes: values.getAll('pane'),
    time: Number.isFinite(time) ? time : 0,
    view: view.length === 6 && view.every(Number.isFinite) ? view : null,
  };
}

export function writeLink(link: Link): string {
  if (link.scene === null) return '';
  const values = new URLSearchParams();
  values.set('scene', link.scene);
  for (const pane of link.panes) values.append('pane', pane);
  values.set('time', link.time.toFixed(3));
  if (link.view !== null) values.set('camera', link.view.map((value) => Number(value.toPrecision(5))).join(','));
  return `#${values.toString()}`;
}
