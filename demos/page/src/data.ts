// A recording as Recorder::toJson writes it (plugin/pintle/record): checked, decoded when it is needed.

export type Vec = [number, number, number];

export type Shape =
  | {kind: 'box'; half: Vec; at?: Vec}
  | {kind: 'sphere'; radius: number}
  | {kind: 'capsule' | 'cylinder' | 'cone'; radius: number; half: number; axis: number}
  | {kind: 'plane'; normal: Vec; constant: number}
  | {kind: 'mesh'; points: Float32Array; triangles: Float32Array}
  | {kind: 'compound'; parts: {pose: number[]; shape: Shape}[]}
  | {kind: 'none'};

export interface Body {
  shape: number;
  kind: 'static' | 'kinematic' | 'dynamic' | 'link';
  mass: number;
  alive: [number, number][];  // frames
  pose: number[] | null;      // of what never moves: position, quaternion (x, y, z, w)
  track: number;
}

export interface Limit {
  kind: 'angle' | 'twist' | 'slide' | 'distance' | 'cone' | 'wedge' | 'bend' | 'turn';
  axis: number;
  low: number;
  high: number;
}

export interface Joint {
  type: string;
  a: number;  // bodies; -1: the world
  b: number;
  inA: number[] | null;
  inB: number[] | null;
  align: string;
  holds: number[];
  order?: number[];  // of turns
  limits: Limit[];
  alive: [number, number][];
}

export interface Series {
  key: string;
  label: string;
  unit: string;
  values: Float32Array;
}

export interface Figure {
  name: string;
  unit: string;
  value: number | null;  // null: not finite, the run was lost
}

export class DataError extends Error {}

type Json = Record<string, unknown>;

function member<T>(of: Json, name: string, is: (value: unknown) => boolean, what: string): T {
  if (!is(of[name])) throw new DataError(`"${name}" is no ${what}`);
  return of[name] as T;
}
const isNumber = (value: unknown): boolean => typeof value === 'number';
const isText = (value: unknown): boolean => typeof value === 'string';
const isList = (value: unknown): boolean => Array.isArray(value);
const isObject = (value: unknown): boolean => typeof value === 'object' && value !== null;

export function floats(base64: unknown, what: string, count?: number): Float32Array {
  if (typeof base64 !== 'string') throw new DataError(`${what} are missing`);
  let bytes: string;
  try {
    bytes = atob(base64);
  } catch {
    throw new DataError(`${what} are no base64`);
  }
  if (bytes.length % 4 !== 0 || (count !== undefined && bytes.length !== 4 * count)) {
    const wanted = count === undefined ? 'a multiple of 4' : String(4 * count);
    throw new DataError(`${what} have ${bytes.length} bytes, not ${wanted}`);
  }
  const buffer = new Uint8Array(bytes.length);
  for (let i = 0; i < bytes.length; ++i) buffer[i] = bytes.charCodeAt(i);
  const view = new DataView(buffer.buffer);
  const values = new Float32Array(bytes.length / 4);
  for (let i = 0; i < values.length; ++i) values[i] = view.getFloat32(4 * i, true);
  return values;
}

function shape(json: Json): Shape {
  switch (json['kind']) {
    case 'mesh':
      return {
        kind: 'mesh',
        points: floats(json['points'], 'points of a mesh'),
        triangles: floats(json['triangles'], 'triangles of a mesh'),
      };
    case 'compound':
      return {
        kind: 'compound',
        parts: member<Json[]>(json, 'parts', isList, 'list').map((part) => ({
          pose: member<number[]>(part, 'pose', isList, 'pose'),
          shape: shape(member<Json>(part, 'shape', isObject, 'shape')),
        })),
      };
    case 'box':
    case 'sphere':
    case 'capsule':
    case 'cylinder':
    case 'cone':
    case 'plane':
      return json as unknown as Shape;
    default:
      return {kind: 'none'};
  }
}

/** One run of a scene. What is listed at once is here; the rest is decoded by `open`. */
export class Run {
  readonly name: string;
  readonly scene: string;
  readonly title: string;
  readonly text: string;
  readonly group: string;
  readonly detail: string;
  readonly colour: string;
  readonly precision: string;
  readonly frames: number;
  readonly stride: number;
  readonly figures: Figure[];
  private opened: OpenRun | null = null;

  constructor(private readonly json: Json) {
    if (json['format'] !== 'pintle-run') throw new DataError('it is no recording of Pintle');
    if (json['version'] !== 1) throw new DataError(`its version is ${String(json['version'])}, not 1`);
    const text = (name: string): string => member<string>(json, name, isText, 'text');
    this.name = text('name');
    this.scene = text('scene');
    this.title = text('title');
    this.text = text('text');
    this.group = text('group');
    this.detail = text('detail');
    this.colour = text('colour');
    this.precision = text('precision');
    this.frames = member<number>(json, 'frames', isNumber, 'number');
    this.stride = member<number>(json, 'stride', isNumber, 'number');
    this.figures = member<Figure[]>(json, 'figures', isList, 'list');
    if (!(this.frames >= 1)) throw new DataError('it has no frames');
  }

  /** Throws DataError. */
  open(): OpenRun {
    this.opened ??= new OpenRun(this, this.json);
    return this.opened;
  }

  figure(name: string): Figure | undefined {
    return this.figures.find((figure) => figure.name === name);
  }
}

export class OpenRun {
  readonly times: Float32Array;
  readonly shapes: Shape[];
  readonly bodies: Body[];
  readonly joints: Joint[];
  readonly poses: Float32Array;  // by tracks, then frames: position, quaternion
  readonly series: Map<string, Series>;
  readonly gravity: Vec;
  readonly maxContacts: number;
  private readonly contactStart: Int32Array;
  private readonly contacts: Float32Array;

  constructor(readonly run: Run, json: Json) {
    const n = run.frames;
    this.times = floats(json['times'], 'times', n);
    this.gravity = member<Vec>(json, 'gravity', isList, 'vector');
    this.shapes = member<Json[]>(json, 'shapes', isList, 'list').map(shape);
    let tracks = 0;
    this.bodies = member<Json[]>(json, 'bodies', isList, 'list').map((body) => {
      const pose = (body['pose'] as number[] | undefined) ?? null;
      const index = member<number>(body, 'shape', isNumber, 'number');
      if (!(index in this.shapes)) throw new DataError(`a body has shape ${index}, which is not there`);
      if (pose === null) ++tracks;
      return {
        shape: index,
        kind: body['kind'] as Body['kind'],
        mass: body['mass'] as number,
        alive: member<[number, number][]>(body, 'alive', isList, 'list'),
        pose,
        track: pose === null ? member<number>(body, 'track', isNumber, 'number') : -1,
      };
    });
    this.poses = floats(json['poses'], 'poses', 7 * tracks * n);
    this.joints = member<Json[]>(json, 'joints', isList, 'list').map((joint) => {
      for (const end of ['a', 'b']) {
        const body = member<number>(joint, end, isNumber, 'number');
        if (body >= this.bodies.length) throw new DataError(`a joint has body ${body}, which is not there`);
      }
      return {...(joint as unknown as Joint), inA: (joint['inA'] as number[]) ?? null, inB: (joint['inB'] as number[]) ?? null};
    });
    this.series = new Map(member<Json[]>(json, 'series', isList, 'list').map((one) => [one['key'] as string, {
      key: one['key'] as string,
      label: one['label'] as string,
      unit: one['unit'] as string,
      values: floats(one['values'], `values of ${String(one['label'])}`, n),
    }]));
    const contacts = member<Json>(json, 'contacts', isObject, 'object');
    const counts = floats(contacts['counts'], 'counts of contacts', n);
    this.contactStart = new Int32Array(n + 1);
    let most = 0;
    for (let i = 0; i < n; ++i) {
      most = Math.max(most, counts[i]!);
      this.contactStart[i + 1] = this.contactStart[i]! + counts[i]!;
    }
    this.maxContacts = most;
    this.contacts = floats(contacts['points'], 'contacts', 4 * this.contactStart[n]!);
  }

  get duration(): number {
    return this.times[this.times.length - 1]!;
  }

  /** A series; at 0, of no unit, where the recording leaves it out for that. Undefined: there is no such number, or it is not known. */
  measured(key: string): {values: Float32Array; unit: string} | undefined {
    const series = this.series.get(key);
    if (series !== undefined || !this.has(key)) return series;
    return {values: this.times.map((_, frame) => (this.isLost(frame) ? NaN : 0)), unit: ''};
  }

  private has(key: string): boolean {
    switch (key) {
      case 'gap': return this.joints.length > 0;
      case 'angleOff': return this.joints.some((joint) => joint.align !== 'nothing');
      case 'overshoot': return this.joints.some((joint) => joint.limits.length > 0);
      case 'impulse':
      case 'step': return false;  // that is never 0, but may not have been measured
      default: return this.bodies.some((body) => body.mass > 0);
    }
  }

  private isLost(frame: number): boolean {
    return this.bodies.some(({pose, track, alive}) => {
      if (pose !== null || !this.isAlive(alive, frame)) return false;
      const at = 7 * (track * this.times.length + frame);
      return !this.poses.subarray(at, at + 7).every(Number.isFinite);
    });
  }

  /** The last frame at or before a time. */
  frameAt(time: number): number {
    let low = 0, high = this.times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle]! <= time + 1e-6) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  isAlive(spans: [number, number][], frame: number): boolean {
    return spans.some(([first, end]) => frame >= first && frame < end);
  }

  /** Position and quaternion at a time, between frames; 'gone' or 'lost' (not finite) where there is none. */
  pose(index: number, frame: number, time: number, to: Float32Array): 'there' | 'gone' | 'lost' {
    const body = this.bodies[index]!;
    if (!this.isAlive(body.alive, frame)) return 'gone';
    if (body.pose !== null) {
      to.set(body.pose);
      return 'there';
    }
    const n = this.times.length;
    const at = 7 * (body.track * n + frame);
    let sum = 0;
    for (let i = 0; i < 7; ++i) sum += to[i] = this.poses[at + i]!;
    if (!Number.isFinite(sum)) return 'lost';
    if (frame + 1 >= n || !this.isAlive(body.alive, frame + 1)) return 'there';
    const span = this.times[frame + 1]! - this.times[frame]!;
    const part = span > 0 ? Math.min(1, (time - this.times[frame]!) / span) : 0;
    if (part <= 1e-4) return 'there';
    const next = at + 7;
    let dot = 0, check = 0;
    for (let i = 0; i < 7; ++i) check += this.poses[next + i]!;
    if (!Number.isFinite(check)) return 'there';
    for (let i = 3; i < 7; ++i) dot += to[i]! * this.poses[next + i]!;
    const sign = dot < 0 ? -1 : 1;  // the same turn, the shorter way
    for (let i = 0; i < 3; ++i) to[i] = to[i]! + part * (this.poses[next + i]! - to[i]!);
    let square = 0;
    for (let i = 3; i < 7; ++i) {
      to[i] = (1 - part) * to[i]! + part * sign * this.poses[next + i]!;
      square += to[i]! ** 2;
    }
    for (let i = 3; i < 7; ++i) to[i] = to[i]! / Math.sqrt(square);
    return 'there';
  }

  /** x, y, z (m) and impulse (N s) of each contact in a frame. */
  contactsOf(frame: number): Float32Array {
    return this.contacts.subarray(4 * this.contactStart[frame]!, 4 * this.contactStart[frame + 1]!);
  }
}

export interface Scene {
  name: string;
  title: string;
  text: string;
  group: string;
  runs: Run[];
}

export interface Page {
  scenes: Scene[];
  problems: string[];  // recordings that can't be read
}

/** All recordings in the document. One that is damaged does not keep the others from being shown. */
export function readPage(document: Document): Page {
  const page: Page = {scenes: [], problems: []};
  const byName = new Map<string, Scene>();
  document.querySelectorAll('script.pintle-run').forEach((element, index) => {
    try {
      let json: Json;
      try {
        json = JSON.parse(element.textContent ?? '') as Json;
      } catch {
        throw new DataError('it is no JSON');
      }
      if (!isObject(json)) throw new DataError('it is no object');
      const run = new Run(json);
      let scene = byName.get(run.scene);
      if (scene === undefined) {
        scene = {name: run.scene, title: run.title, text: run.text, group: run.group, runs: []};
        byName.set(run.scene, scene);
        page.scenes.push(scene);
      }
      scene.runs.push(run);
    } catch (error) {
      if (!(error instanceof DataError)) throw error;
      page.problems.push(`Recording ${index + 1} can't be read: ${error.message}.`);
    }
    element.textContent = '';  // it is in memory now, once
  });
  return page;
}
