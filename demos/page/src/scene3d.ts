// All panes under one camera and one clock: one canvas, one renderer, a part of it for each pane.

import * as THREE from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

import {colourOf, isDark} from './colours';
import type {OpenRun, Run, Scene} from './data';
import {fit, frameScene, View3d, type Framing, type ViewOptions} from './view3d';

export interface Pane {
  run: Run;
  element: HTMLElement;
  view: View3d;
}

// A processor that draws without help gets less to do.
const isSoftware = (): boolean => {
  const context = document.createElement('canvas').getContext('webgl2');
  if (context === null) return false;
  const info = context.getExtension('WEBGL_debug_renderer_info');
  const name = String(context.getParameter(info?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER));
  context.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
};

const fieldOfView = 34;  // degrees

export class Stage {
  readonly camera = new THREE.PerspectiveCamera(fieldOfView, 1, 0.01, 1000);
  readonly renderer: THREE.WebGLRenderer;
  readonly controls: OrbitControls;
  readonly plain: boolean;  // drawn in software, with less trouble; ?full in the URL: with all
  panes: Pane[] = [];
  framesPerSecond = 0;
  private framing: Framing | null = null;
  private trusted: OpenRun | null = null;
  private isFitted = false;  // nobody has moved the camera since
  private kept: View3d | null = null;
  private followed = new THREE.Vector3();  // where the path was last
  private ratio = Math.min(devicePixelRatio, 2);
  private shadowSize = 2048;
  private times: number[] = [];

  constructor(private readonly element: HTMLElement, readonly canvas: HTMLCanvasElement, onCamera: () => void) {
    this.plain = isSoftware() && !location.search.includes('full');
    if (this.plain) this.ratio = 1;
    // Nothing of the document is seen through it.
    const context = canvas.getContext('webgl2', {alpha: false, antialias: !this.plain, powerPreference: 'high-performance'});
    this.renderer = new THREE.WebGLRenderer({canvas, ...(context === null ? {} : {context})});
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.renderer.setScissorTest(true);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, element);
    this.controls.enableDamping = false;
    this.controls.addEventListener('change', onCamera);
    this.controls.addEventListener('start', () => (this.isFitted = false));
  }

  /** Where the camera stands and looks; six numbers. */
  get view(): number[] {
    return [...this.camera.position.toArray(), ...this.controls.target.toArray()];
  }
  set view(numbers: number[]) {
    this.camera.position.fromArray(numbers, 0);
    this.controls.target.fromArray(numbers, 3);
    this.controls.update();
    this.isFitted = false;
  }

  setScene(scene: Scene): void {
    const trusted = scene.runs.find((run) => run.name.startsWith('exact')) ??
      scene.runs.find((run) => run.name.startsWith('pintle')) ?? scene.runs[0]!;
    this.trusted = trusted.open();
    this.framing = frameScene(this.trusted);
    this.followed = this.framing.centre.clone();
    this.clear();
    this.fit();
  }

  /** Throws DataError if a run is damaged. */
  addPane(run: Run, index: number, element: HTMLElement): Pane {
    const view = new View3d(run.open(), this.framing!, this.plain);
    view.setTheme(isDark(), colourOf(run, index));
    const pane = {run, element, view};
    this.panes.push(pane);
    return pane;
  }

  clear(): void {
    for (const pane of this.panes) pane.view.dispose();
    this.panes = [];
  }

  setTheme(indexOf: (run: Run) => number): void {
    for (const {run, view} of this.panes) view.setTheme(isDark(), colourOf(run, indexOf(run)));
  }

  /** Puts the camera where all that moves is seen. */
  fit(): void {
    if (this.framing === null) return;
    const {radius, direction, centre} = this.framing;
    const box = (this.panes[0]?.element ?? this.element).getBoundingClientRect();
    const aspect = box.height > 0 ? box.width / box.height : 1;
    const {target, distance} = fit(this.framing, fieldOfView, aspect);
    target.add(this.followed).sub(centre);
    this.camera.near = radius / 100;
    this.camera.far = 100 * radius;
    this.camera.position.copy(target).addScaledVector(direction, distance);
    this.controls.target.copy(target);
    this.controls.update();
    this.isFitted = true;
  }

  /** In panes of another size. */
  resize(): void {
    if (this.isFitted) this.fit();
  }

  /** Turns (rad), moves (parts of the distance) and nears the camera, as the mouse does. */
  move(turn: number, tilt: number, nearer: number, right: number, up: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const spherical = new THREE.Spherical().setFromVector3(offset.applyEuler(new THREE.Euler(-Math.PI / 2, 0, 0)));
    spherical.theta += turn;
    spherical.phi = Math.min(Math.max(spherical.phi + tilt, 0.02), Math.PI - 0.02);
    spherical.radius *= nearer;
    offset.setFromSpherical(spherical).applyEuler(new THREE.Euler(Math.PI / 2, 0, 0));
    const shift = new THREE.Vector3(right, up, 0).multiplyScalar(spherical.radius).applyQuaternion(this.camera.quaternion);
    this.controls.target.add(shift);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.isFitted = false;
  }

  draw(time: number, options: ViewOptions): void {
    const width = this.element.clientWidth, height = this.element.clientHeight;
    if (width === 0 || height === 0 || this.panes.length === 0) return;
    const size = this.renderer.getSize(new THREE.Vector2());
    if (size.x !== width || size.y !== height || this.renderer.getPixelRatio() !== this.ratio) {
      this.renderer.setPixelRatio(this.ratio);
      this.renderer.setSize(width, height, false);
    }
    this.follow(time);
    const outer = this.element.getBoundingClientRect();
    const dark = isDark();
    // Lines between the panes.
    this.renderer.setScissorTest(false);
    this.renderer.setClearColor(dark ? '#2a313a' : '#dfe4ea');
    this.renderer.clear();
    this.renderer.setScissorTest(true);
    for (const {view, element} of this.panes) {
      const box = element.getBoundingClientRect();
      if (box.width === 0 || box.height === 0) continue;
      const x = box.left - outer.left, y = outer.bottom - box.bottom;
      this.camera.aspect = box.width / box.height;
      this.camera.updateProjectionMatrix();
      this.renderer.setViewport(x, y, box.width, box.height);
      this.renderer.setScissor(x, y, box.width, box.height);
      view.setShadowSize(this.shadowSize);
      view.moveTo(this.followed);
      view.update(time, options, dark);
      this.renderer.render(view.scene, this.camera);
    }
  }

  /** The camera keeps its place beside what goes far. */
  follow(time: number): void {
    const path = this.framing?.path ?? [];
    if (path.length === 0 || this.trusted === null) return;
    const frame = this.trusted.frameAt(time), next = Math.min(frame + 1, path.length - 1);
    const span = this.trusted.times[next]! - this.trusted.times[frame]!;
    const part = span > 0 ? Math.min(1, (time - this.trusted.times[frame]!) / span) : 0;
    const now = path[frame]!.clone().lerp(path[next]!, part);
    const shift = now.clone().sub(this.followed);
    this.followed = now;
    this.camera.position.add(shift);
    this.controls.target.add(shift);
  }

  /** Counts frames while it plays, and takes less trouble over each where a computer is slow. */
  count(now: number): void {
    this.times.push(now);
    if (this.times.length < 12) return;
    const milliseconds = (now - this.times[0]!) / (this.times.length - 1);
    this.framesPerSecond = 1000 / milliseconds;
    this.times = [];
    if (milliseconds < 34) return;
    if (this.shadowSize > 1024) this.shadowSize = 1024;
    else if (this.ratio > 1) this.ratio = 1;
    else if (this.shadowSize > 512) this.shadowSize = 512;
    else if (this.ratio > 0.7) this.ratio = 0.7;
    else if (this.ratio > 0.5) this.ratio = 0.5;
  }
  pauseCount(): void {
    this.times = [];
  }

  /** A small picture of a run, about halfway. */
  picture(scene: Scene, run: Run, to: HTMLCanvasElement): void {
    const open = run.open();
    const time = 0.4 * open.duration;
    const framing = frameScene(open, open.frameAt(time));
    const colour = colourOf(run, scene.runs.indexOf(run));
    const view = new View3d(open, framing, this.plain);
    view.setTheme(isDark(), colour);
    view.setShadowSize(512);
    const width = to.width, height = to.height;
    const camera = new THREE.PerspectiveCamera(fieldOfView, width / height, framing.radius / 100, 100 * framing.radius);
    camera.up.set(0, 0, 1);
    const {target, distance} = fit(framing, fieldOfView, width / height);
    camera.position.copy(target).addScaledVector(framing.direction, distance);
    camera.lookAt(target);
    this.renderer.setPixelRatio(1);
    this.renderer.setSize(width, height, false);
    this.renderer.setViewport(0, 0, width, height);
    this.renderer.setScissor(0, 0, width, height);
    view.update(time, {joints: true, limits: view.joints.hasFewLimits, magnified: false, contacts: false, shadows: true}, isDark());
    this.renderer.render(view.scene, camera);
    to.getContext('2d')!.drawImage(this.canvas, 0, 0, width, height);
    // One view is kept, and with it the compiled shaders, which the next one shares.
    this.kept?.dispose();
    this.kept = view;
  }
}
