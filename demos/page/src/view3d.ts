// One run in one pane: its bodies, floor, light and joints as a three.js scene.

import * as THREE from 'three';

import {mix} from './colours';
import type {OpenRun} from './data';
import {Joints3d, type JointOptions} from './joints3d';
import {flatMaterial, Many, plainMaterial, sun} from './many';
import {geometryOf, radiusOf} from './shapes';

export interface ViewOptions extends JointOptions {
  contacts: boolean;
  shadows: boolean;
}

/** What the camera looks at, the same for all runs of a scene. */
export interface Framing {
  centre: THREE.Vector3;
  radius: number;
  floors: THREE.Plane[];  // at least one; the first one takes the shadows of a renderer in software
  direction: THREE.Vector3;  // from the centre to the camera
  points: THREE.Vector3[];   // to be seen
  margin: number;            // m, about them
  path: THREE.Vector3[];     // of the centre, by frames of the run that is trusted; empty: it stays
}

const pose = new Float32Array(7);
const position = new THREE.Vector3(), turn = new THREE.Quaternion(), one = new THREE.Vector3(1, 1, 1),
      matrix = new THREE.Matrix4(), identity = new THREE.Matrix4();

/** Of a static plane, or of a level static box so large that it is the ground: the plane that it is drawn as. Else null. */
export function groundOf(run: OpenRun, index: number, radius: number): THREE.Plane | null {
  const body = run.bodies[index]!, shape = run.shapes[body.shape]!;
  if (body.mass !== 0 || body.pose === null) return null;
  const [x, y, z, ...turned] = body.pose as [number, number, number, number, number, number, number];
  const stand = (normal: THREE.Vector3, constant: number): THREE.Plane => {
    const point = normal.clone().multiplyScalar(constant), turn = new THREE.Quaternion(...turned);
    return new THREE.Plane().setFromNormalAndCoplanarPoint(normal.applyQuaternion(turn), point.applyQuaternion(turn).add(new THREE.Vector3(x, y, z)));
  };
  if (shape.kind === 'plane') return stand(new THREE.Vector3(...shape.normal), shape.constant);
  if (shape.kind !== 'box' || Math.min(shape.half[0], shape.half[1]) <= Math.max(1.2 * radius, 8)) return null;
  const top = stand(new THREE.Vector3(0, 0, 1), shape.half[2] + (shape.at?.[2] ?? 0));
  return isLevel(top) ? top : null;
}
const isLevel = ({normal}: THREE.Plane): boolean => normal.z > 0.999;

function gridTexture(dark: boolean, plain: boolean): THREE.Texture {
  const size = 256;
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = size;
  const context = canvas.getContext('2d')!;
  context.fillStyle = dark ? '#23282f' : '#f1f3f6';
  context.fillRect(0, 0, size, size);
  context.strokeStyle = dark ? '#343b45' : '#d5dae1';
  for (let i = 0; i <= 5; ++i) {
    const at = (i * size) / 5;
    context.lineWidth = i % 5 === 0 ? 5 : 1.6;
    context.beginPath();
    context.moveTo(at, 0);
    context.lineTo(at, size);
    context.moveTo(0, at);
    context.lineTo(size, at);
    context.stroke();
  }
  const texture = new THREE.CanvasTexture(canvas);
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.anisotropy = plain ? 1 : 8;
  if (plain) texture.minFilter = THREE.LinearMipmapNearestFilter;
  return texture;
}

export class View3d {
  readonly scene = new THREE.Scene();
  readonly joints: Joints3d;
  lost: number[] = [];  // bodies that are not finite now
  gone = 0;             // of those that were there at first
  private readonly bodies: Many;
  private readonly drawn: number[] = [];  // bodies, in the order of what is drawn
  private readonly matrices: (THREE.Matrix4 | null)[];
  private readonly store: THREE.Matrix4[];
  private readonly contacts: Many;
  private readonly light = new THREE.DirectionalLight('#fffaf2', 2.0);
  private readonly sky = new THREE.HemisphereLight('#f2f6ff', '#c3c7cf', 1.6);
  private readonly floors: THREE.Mesh<THREE.PlaneGeometry, THREE.MeshLambertMaterial | THREE.MeshBasicMaterial>[];
  private readonly flat: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial> | null = null;  // shadows, where it is plain
  private readonly contactSize: number;

  /** `plain`: for a renderer in software. */
  constructor(readonly run: OpenRun, private readonly framing: Framing, private readonly plain: boolean) {
    const {centre, radius} = framing;
    this.store = run.bodies.map(() => new THREE.Matrix4());
    this.matrices = run.bodies.map(() => null);

    const isFew = run.bodies.length <= 60, detail = isFew ? 4 : !plain ? 3 : run.bodies.length > 250 ? 1 : 2;
    const shapes = run.shapes.map((shape) => geometryOf(shape, detail));
    run.bodies.forEach((body, index) => {
      if (groundOf(run, index, radius) === null && shapes[body.shape] !== null) this.drawn.push(index);
    });
    const isOpen = run.shapes.some((shape) => shape.kind === 'mesh');
    this.bodies = new Many(this.drawn.map((body) => shapes[run.bodies[body]!.shape]!), this.drawn.length,
                           plain ? plainMaterial() : new THREE.MeshLambertMaterial(), true, plain);
    (this.bodies.mesh.material as THREE.Material).side = isOpen ? THREE.DoubleSide : THREE.FrontSide;
    if (plain) {
      this.flat = new THREE.Mesh(this.bodies.mesh.geometry, flatMaterial(framing.floors[0]!));
      this.flat.frustumCulled = false;
      this.scene.add(this.flat);
    }
    this.bodies.mesh.castShadow = this.bodies.mesh.receiveShadow = true;
    for (const shape of shapes) shape?.dispose();

    // A square of the grid is a round number of metres.
    const cell = 10 ** Math.round(Math.log10(radius / 2));
    const extent = 40 * Math.max(radius, cell);
    const grid = new THREE.PlaneGeometry(extent, extent);
    const uv = grid.getAttribute('uv') as THREE.BufferAttribute;
    for (let i = 0; i < uv.count; ++i) uv.setXY(i, (uv.getX(i) * extent) / (5 * cell), (uv.getY(i) * extent) / (5 * cell));
    const middle = centre.clone().divideScalar(cell).round().multiplyScalar(cell);
    this.floors = framing.floors.map((plane) => {
      // Tilted ones are as much darker or brighter as the sun would make them.
      const light = 0.5 + 0.5 * Math.max(0, plane.normal.dot(sun)) / sun.z;
      const material = plain ? new THREE.MeshBasicMaterial({color: new THREE.Color().setScalar(light)}) : new THREE.MeshLambertMaterial();
      const floor = new THREE.Mesh(grid, material);
      floor.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), plane.normal);
      plane.projectPoint(middle, floor.position);
      floor.receiveShadow = true;
      return floor;
    });

    this.moveTo(centre);
    const camera = this.light.shadow.camera;
    camera.left = camera.bottom = -1.7 * radius;
    camera.right = camera.top = 1.7 * radius;
    camera.near = 0.05 * radius;
    camera.far = 8 * radius;
    this.light.shadow.mapSize.set(1024, 1024);
    this.light.shadow.bias = -0.0006;
    this.light.shadow.normalBias = 0.006 * radius;
    this.light.shadow.radius = 3;

    this.contactSize = 0.016 * radius;
    this.contacts = new Many(
      new THREE.IcosahedronGeometry(1, 1), Math.max(1, run.maxContacts),
      new THREE.MeshBasicMaterial({color: '#ff9f1c', transparent: true, opacity: 0.9, depthTest: false}), false, plain);
    this.contacts.mesh.renderOrder = 9;
    this.joints = new Joints3d(run, radius, plain);
    this.scene.add(...this.floors, this.light, this.light.target, this.sky, this.bodies.mesh, this.contacts.mesh, this.joints.group);
  }

  setTheme(dark: boolean, colour: string): void {
    const background = dark ? '#171b21' : '#eef1f5';
    this.scene.background = new THREE.Color(background);
    this.scene.fog = new THREE.Fog(background, 5 * this.framing.radius, 15 * this.framing.radius);
    this.light.intensity = dark ? 1.9 : 2.1;
    this.sky.intensity = dark ? 1.15 : 1.55;
    this.floors[0]!.material.map?.dispose();
    const grid = gridTexture(dark, this.plain);
    for (const {material} of this.floors) {
      material.map = grid;
      material.needsUpdate = true;
    }
    (this.flat?.material.uniforms['colour']?.value as THREE.Color | undefined)?.set(dark ? '#12151a' : '#b4bac3').convertLinearToSRGB();
    const still = new THREE.Color(dark ? '#3f4955' : '#d3d9e1');
    const moving = [mix(colour, '#ffffff', 0.1), mix(colour, '#ffffff', 0.38)].map((c) => new THREE.Color(c));
    let count = 0;
    const shade = this.run.bodies.map((body) => (body.mass === 0 ? still : moving[count++ % 2]!));
    this.drawn.forEach((body, i) => this.bodies.setColour(i, shade[body]!));
  }

  /** The matrix of a body as it is drawn; null where it is not. For tests, too. */
  matrixOf(body: number): THREE.Matrix4 | null {
    return body < 0 ? identity : this.matrices[body] ?? null;
  }

  /** All that is drawn but the joints' axes and limits, as it is drawn: for tests. */
  drawnNow(): {corners: number[][]; bodies: number[]; floors: number[][]; gaps: number[][]; anchors: number[][]; contacts: number[][]} {
    return {
      corners: this.bodies.drawnCorners(), bodies: this.drawn,
      floors: this.floors.map(({matrixWorld}) => matrixWorld.toArray()),
      gaps: this.joints.gaps.drawnCorners(), anchors: this.joints.anchorsA.drawnCorners(), contacts: this.contacts.drawnCorners(),
    };
  }

  /** Light and floor go along with what the camera follows. */
  moveTo(centre: THREE.Vector3): void {
    this.light.position.copy(centre).addScaledVector(sun, 3.55 * this.framing.radius);
    this.light.target.position.copy(centre);
  }

  update(time: number, options: ViewOptions, dark: boolean): void {
    const frame = this.run.frameAt(time);
    this.lost = [];
    this.gone = 0;
    this.run.bodies.forEach((_, body) => {
      const state = this.run.pose(body, frame, time, pose);
      if (state === 'lost') this.lost.push(body);
      if (state === 'gone') ++this.gone;
      const far = state === 'there' && Math.hypot(pose[0]!, pose[1]!, pose[2]!) > 1e6;
      if (state !== 'there' || far) {
        this.matrices[body] = null;
        return;
      }
      position.set(pose[0]!, pose[1]!, pose[2]!);
      turn.set(pose[3]!, pose[4]!, pose[5]!, pose[6]!);
      this.matrices[body] = this.store[body]!.compose(position, turn, one);
    });
    this.drawn.forEach((body, i) => this.bodies.setMatrix(i, this.matrices[body]!));
    this.bodies.update();
    this.light.castShadow = options.shadows && !this.plain;
    if (this.flat !== null) this.flat.visible = options.shadows;
    this.joints.update(frame, (body) => this.matrixOf(body), options, dark);

    let count = 0;
    if (options.contacts) {
      const points = this.run.contactsOf(frame);
      let most = 0;
      for (let i = 3; i < points.length; i += 4) most = Math.max(most, points[i]!);
      for (let i = 0; i < points.length; i += 4, ++count) {
        const size = this.contactSize * (0.5 + Math.sqrt(most > 0 ? points[i + 3]! / most : 0));
        matrix.makeScale(size, size, size).setPosition(points[i]!, points[i + 1]!, points[i + 2]!);
        this.contacts.setMatrix(count, matrix);
      }
    }
    this.contacts.setCount(count);
    this.contacts.update();
  }

  setShadowSize(size: number): void {
    const shadow = this.light.shadow;
    if (shadow.mapSize.x === size) return;
    shadow.mapSize.set(size, size);
    shadow.map?.dispose();
    shadow.map = null;
  }

  dispose(): void {
    this.joints.dispose();
    this.bodies.dispose();
    this.flat?.material.dispose();
    this.floors[0]!.geometry.dispose();
    this.floors[0]!.material.map?.dispose();
    for (const {material} of this.floors) material.dispose();
    this.contacts.dispose();
    this.light.shadow.map?.dispose();
    this.light.dispose();
  }
}

/** How far from which point a camera sees all of it, along the framing's direction. */
export function fit(framing: Framing, fieldOfView: number, aspect: number): {target: THREE.Vector3; distance: number} {
  const tall = 0.86 * Math.tan((fieldOfView * Math.PI) / 360), wide = tall * aspect;
  const back = framing.direction, right = new THREE.Vector3(0, 0, 1).cross(back).normalize(), up = back.clone().cross(right);
  const low = new THREE.Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
  const local = framing.points.map((point) => {
    const from = point.clone().sub(framing.centre);
    const own = new THREE.Vector3(from.dot(right), from.dot(up), from.dot(back));
    low.min(own);
    high.max(own);
    return own;
  });
  const middle = low.clone().add(high).multiplyScalar(0.5);
  let distance = 2 * framing.margin;
  for (const point of local) {
    const across = (Math.abs(point.x - middle.x) + framing.margin) / wide, along = (Math.abs(point.y - middle.y) + framing.margin) / tall;
    distance = Math.max(distance, point.z - middle.z + Math.max(across, along));
  }
  const target = framing.centre.clone().addScaledVector(right, middle.x).addScaledVector(up, middle.y).addScaledVector(back, middle.z);
  return {target, distance};
}

type Range = [low: THREE.Vector3, high: THREE.Vector3];

// Of points, but for those that fly away.
function rangeOf(points: THREE.Vector3[], part: number): Range {
  const low = new THREE.Vector3(), high = new THREE.Vector3();
  for (const axis of ['x', 'y', 'z'] as const) {
    const sorted = points.map((point) => point[axis]).sort((a, b) => a - b);
    const at = (share: number): number => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
    low[axis] = at(part);
    high[axis] = at(1 - part);
  }
  return [low, high];
}

// Of what moves: what joints hold, all the time, and what is free, where it starts. A stone that is thrown would make the rest small.
function positions(run: OpenRun, frames: number[]): THREE.Vector3[] {
  const points: THREE.Vector3[] = [];
  const isHeld = (index: number, frame: number): boolean =>
    run.joints.length === 0 || run.joints.some(({a, b, alive}) => (a === index || b === index) && run.isAlive(alive, frame));
  run.bodies.forEach((body, index) => {
    if (body.mass === 0 && body.pose !== null) return;
    for (const frame of frames) {
      if (frame > 0 && !isHeld(index, frame)) continue;
      if (run.pose(index, frame, run.times[frame]!, pose) === 'there')
        points.push(new THREE.Vector3(pose[0]!, pose[1]!, pose[2]!));
    }
  });
  return points;
}

// Joints to the world belong to what is looked at.
function addAnchors(run: OpenRun, [low, high]: Range): void {
  for (const joint of run.joints) {
    if (joint.inA === null || (joint.a >= 0 && run.bodies[joint.a]!.pose === null)) continue;
    const at = new THREE.Vector3(joint.inA[0], joint.inA[1], joint.inA[2]);
    const base = joint.a >= 0 ? run.bodies[joint.a]!.pose! : null;
    if (base !== null) {
      at.applyQuaternion(new THREE.Quaternion(base[3], base[4], base[5], base[6]));
      at.add(new THREE.Vector3(base[0], base[1], base[2]));
    }
    if (at.length() > 1e4) continue;
    low.min(at);
    high.max(at);
  }
}

/** A view that holds what moves, by the run that is trusted most; `only`: in that frame. */
export function frameScene(run: OpenRun, only?: number): Framing {
  const n = run.times.length;
  const frames = only !== undefined ? [only] : [...Array(24).keys()].map((i) => Math.round((i * (n - 1)) / 23));
  let reach = 0;
  for (const body of run.bodies) {
    if (body.mass > 0 || body.pose === null) reach = Math.max(reach, radiusOf(run.shapes[body.shape]!));
  }
  const range = rangeOf(positions(run, frames), only === undefined ? 0.03 : 0);
  if (only === undefined) {
    const [low, high] = rangeOf(positions(run, [0]), 0);
    range[0].min(low);
    range[1].max(high);
  }
  addAnchors(run, range);
  const sizeOf = ([low, high]: Range): number => {
    const own = Math.max(Math.min(reach, low.distanceTo(high)) || reach, 0.05);
    return Math.max(low.distanceTo(high) / 2 + 0.6 * own, 1.2 * reach, 0.1);
  };
  let radius = sizeOf(range);
  let centre = range[0].clone().add(range[1]).multiplyScalar(0.5);

  // What goes far away as a whole is followed.
  const path: THREE.Vector3[] = [];
  const start = rangeOf(positions(run, [0]), 0);
  if (only === undefined && sizeOf(start) < 0.4 * radius && !run.joints.some((joint) => joint.a < 0 || run.bodies[joint.a]!.mass === 0)) {
    for (let frame = 0; frame < n; ++frame) {
      const [low, high] = rangeOf(positions(run, [frame]), 0);
      path.push(low.add(high).multiplyScalar(0.5));
    }
    radius = 1.35 * sizeOf(start);
    centre = path[0]!.clone();
  }

  // Level ground before what is tilted; where there is none, one below all.
  const floors: THREE.Plane[] = [];
  run.bodies.forEach((_, index) => {
    const plane = groundOf(run, index, radius);
    if (plane !== null && !floors.some((one) => one.equals(plane))) floors.push(plane);
  });
  floors.sort((a, b) => Number(isLevel(b)) - Number(isLevel(a)));
  if (floors.length === 0) floors.push(new THREE.Plane(new THREE.Vector3(0, 0, 1), -(range[0].z - 0.75 * Math.min(reach, radius) - 0.02 * radius)));
  // From the side that the most is seen of, a little from above.
  const wide = range[1].clone().sub(range[0]);
  const direction = wide.y > 1.6 * wide.x ? new THREE.Vector3(1, -0.35, 0.36) : new THREE.Vector3(0.42, -1, 0.38);
  const [low, high] = range;
  const seen = path.length > 0 ? positions(run, [0]) : positions(run, frames).filter((point) =>
    (['x', 'y', 'z'] as const).every((axis) => point[axis] >= low[axis] && point[axis] <= high[axis]));
  const points = [...seen, ...(path.length > 0 ? [] : [low, high])];
  return {centre, radius, floors, direction: direction.normalize(), points, margin: path.length > 0 ? 1.3 * reach : reach, path};
}
