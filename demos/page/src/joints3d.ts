// Joints as they stand: anchors, axes, limits and the gap between anchors.

import * as THREE from 'three';

import type {Joint, Limit, OpenRun} from './data';
import {limitGeometry, reading, stand} from './limits3d';
import {Many} from './many';
import {radiusOf} from './shapes';

export interface JointOptions {
  joints: boolean;
  limits: boolean;
  magnified: boolean;  // gaps, ten times
}

const fewLimits = 6;  // of a scene
const gapColour = '#e5173f', anchorColour = '#f2c200', axisColour = '#2b2b2b', limitColour = '#8a4fd0';

// Seen through bodies. What is open is seen from both sides, in one pass.
function overlay(colour: string, opacity: number, side: THREE.Side = THREE.FrontSide): THREE.MeshBasicMaterial {
  return new THREE.MeshBasicMaterial({
    color: colour, transparent: true, opacity, depthTest: false, depthWrite: false, side, forceSinglePass: true, fog: false,
  });
}

function copies(geometry: THREE.BufferGeometry, material: THREE.MeshBasicMaterial, count: number, order: number,
                plain: boolean): Many {
  const many = new Many(geometry, Math.max(1, count), material, false, plain);
  many.mesh.renderOrder = order;
  geometry.dispose();
  return many;
}

const anchorA = new THREE.Vector3(), anchorB = new THREE.Vector3(), direction = new THREE.Vector3(),
      matrix = new THREE.Matrix4(), scale = new THREE.Vector3(), turn = new THREE.Quaternion(),
      middle = new THREE.Vector3(), up = new THREE.Vector3(0, 1, 0), frameA = new THREE.Matrix4(), frameB = new THREE.Matrix4();

function frame(of: number[], to: THREE.Matrix4): THREE.Matrix4 {
  const [x, y, z, qx, qy, qz, qw] = of as [number, number, number, number, number, number, number];
  return to.compose(new THREE.Vector3(x, y, z), new THREE.Quaternion(qx, qy, qz, qw), new THREE.Vector3(1, 1, 1));
}

interface Drawn {
  joint: Joint;
  inA: THREE.Matrix4;
  inB: THREE.Matrix4;
  size: number;      // m
  reach: number;     // m, of its limits
  axis: THREE.Vector3 | null;  // of frame a: what it turns about or slides along
  slides: Limit[];
}

// Those that look alike.
interface LimitGroup {
  many: Many;
  joints: {one: Drawn; limit: Limit}[];
}

/** A limit as it is drawn, for tests. */
export interface ShownLimit {
  kind: string;
  low: number;
  high: number;
  at: number;      // rad
  beyond: number;  // rad
}

/** The joints of one run in one pane. */
export class Joints3d {
  readonly group = new THREE.Group();
  readonly gaps: Many;
  private readonly drawn: Drawn[] = [];
  private readonly visibleGap: number;  // m
  private readonly sparse: boolean;
  readonly anchorsA: Many;
  private readonly anchorsB: Many;
  private readonly axes: Many;
  private readonly slides: Many;
  private readonly pointers: Many;
  private readonly limits: LimitGroup[] = [];

  /** So that all of them can be seen at once. */
  get hasFewLimits(): boolean {
    return this.limits.reduce((sum, {joints}) => sum + joints.length, 0) <= fewLimits;
  }

  /** `plain`: for a renderer in software, where of many joints no more than anchors and gaps are drawn. */
  constructor(private readonly run: OpenRun, sceneRadius: number, plain: boolean) {
    this.visibleGap = 4e-4 * sceneRadius;
    this.sparse = plain && run.joints.length > 150;
    const groups = new Map<string, {geometry: THREE.BufferGeometry; joints: LimitGroup['joints']}>();
    let surfaces = 0;
    const few = run.joints.reduce((sum, joint) => sum + joint.limits.length, 0) <= fewLimits;
    for (const joint of run.joints) {
      if (joint.inA === null || joint.inB === null) continue;
      const moving = [{body: joint.a, pivot: joint.inA}, {body: joint.b, pivot: joint.inB}]
        .filter(({body}) => body >= 0 && run.bodies[body]!.mass > 0);
      const radii = moving.map(({body}) => radiusOf(run.shapes[run.bodies[body]!.shape]!));
      // Few limits are as long as the bodies from the joint on, and many as half of that.
      const ends = radii.map((radius, i) => (few ? 0.8 * (radius + Math.hypot(...moving[i]!.pivot.slice(0, 3))) : 0.9 * radius));
      const size = Math.min(Math.max(0.7 * Math.min(...radii, sceneRadius), 0.012 * sceneRadius), 0.16 * sceneRadius);
      const axis = joint.align === 'z' || joint.limits.some((l) => l.kind === 'angle' || l.kind === 'wedge') ? new THREE.Vector3(0, 0, 1)
        : joint.align === 'x' || (joint.align === 'all' && joint.holds[0] === 0) ? new THREE.Vector3(1, 0, 0)
        : joint.align === 'across' ? new THREE.Vector3(0, 0, 1) : null;
      const one: Drawn = {
        joint, size, axis,
        reach: Math.min(Math.max(Math.min(...ends, sceneRadius), size), (few ? 0.7 : 0.45) * sceneRadius),
        inA: frame(joint.inA, new THREE.Matrix4()),
        inB: frame(joint.inB, new THREE.Matrix4()),
        slides: joint.limits.filter((limit) => limit.kind === 'slide' && limit.high - limit.low < 1e3),
      };
      this.drawn.push(one);
      for (const limit of joint.limits) {
        const key = [limit.kind, limit.axis, limit.low, limit.high].join();
        let group = groups.get(key);
        if (group === undefined) {
          const geometry = limitGeometry(limit);
          if (geometry === null) continue;
          group = {geometry, joints: []};
          groups.set(key, group);
        }
        group.joints.push({one, limit});
        ++surfaces;
      }
    }
    const count = this.drawn.length;
    const ball = this.sparse ? new THREE.TetrahedronGeometry(1.4)
      : count > 100 ? new THREE.OctahedronGeometry(1) : new THREE.IcosahedronGeometry(1, 2);
    const rod = new THREE.CylinderGeometry(1, 1, 1, count > 100 ? 3 : 8, 1, true);
    this.anchorsA = copies(ball, overlay(anchorColour, 0.95), count, 12, plain);
    this.anchorsB = copies(ball, overlay('#ffffff', 0.95), count, 13, plain);
    this.axes = copies(rod, overlay(axisColour, 0.95), count, 11, plain);
    this.slides = copies(rod, overlay(limitColour, 0.95), 3 * count, 11, plain);
    this.gaps = copies(rod, overlay(gapColour, 0.95), count, 14, plain);
    this.pointers = copies(rod, overlay(limitColour, 0.95), surfaces, 11, plain);
    for (const {geometry, joints} of groups.values())
      this.limits.push({many: copies(geometry, overlay(limitColour, 0.3, THREE.DoubleSide), joints.length, 10, plain), joints});
    this.group.add(...this.all().map((many) => many.mesh));
  }

  private all(): Many[] {
    return [this.anchorsA, this.anchorsB, this.axes, this.slides, this.pointers, this.gaps, ...this.limits.map(({many}) => many)];
  }

  /** `poseOf`: the matrix of a body, null where it is not drawn. */
  update(frameIndex: number, poseOf: (body: number) => THREE.Matrix4 | null, options: JointOptions, dark: boolean): void {
    let anchors = 0, axes = 0, gaps = 0, slides = 0;
    (this.axes.mesh.material as THREE.MeshBasicMaterial).color.set(dark ? '#f2f2f2' : axisColour);
    const shown = new Set<Drawn>();
    for (const one of this.drawn) {
      if (!this.run.isAlive(one.joint.alive, frameIndex)) continue;
      const a = poseOf(one.joint.a), b = poseOf(one.joint.b);
      if (a === null || b === null) continue;
      shown.add(one);
      frameA.multiplyMatrices(a, one.inA);
      frameB.multiplyMatrices(b, one.inB);
      anchorA.setFromMatrixPosition(frameA);
      anchorB.setFromMatrixPosition(frameB);
      const thick = 0.055 * one.size;
      if (options.joints) {
        this.ball(this.anchorsA, anchors, anchorA, 0.11 * one.size);
        if (!this.sparse) this.ball(this.anchorsB, anchors, anchorB, 0.06 * one.size);
        ++anchors;
        if (one.axis !== null && !this.sparse) {
          direction.copy(one.axis).transformDirection(frameA).multiplyScalar(one.size);
          this.rod(this.axes, axes++, anchorA.clone().sub(direction), anchorA.clone().add(direction), 0.5 * thick);
        }
      }
      if (options.limits) {
        for (const slide of one.slides) {
          direction.setFromMatrixColumn(frameA, slide.axis);
          this.rod(this.slides, slides++, anchorA.clone().addScaledVector(direction, slide.low),
                   anchorA.clone().addScaledVector(direction, slide.high), 0.6 * thick);
        }
      }
      direction.subVectors(anchorB, anchorA);
      // Only what the joint holds is a gap: not the way along a slider.
      for (let axis = 0; axis < 3; ++axis) {
        if (one.joint.holds[axis] !== 0) continue;
        middle.setFromMatrixColumn(frameA, axis);
        direction.addScaledVector(middle, -direction.dot(middle));
      }
      if (options.joints && direction.length() > this.visibleGap / (options.magnified ? 10 : 1) && one.joint.holds.some((held) => held !== 0)) {
        const end = anchorA.clone().addScaledVector(direction, options.magnified ? 10 : 1);
        this.rod(this.gaps, gaps++, anchorA, end, thick);
      }
    }
    this.finish(this.anchorsA, anchors);
    this.finish(this.anchorsB, this.sparse ? 0 : anchors);
    this.finish(this.axes, axes);
    this.finish(this.gaps, gaps);
    this.finish(this.slides, slides);
    let pointers = 0;
    for (const {many, joints} of this.limits) {
      let count = 0;
      for (const {one, limit} of options.limits ? joints : []) {
        if (!shown.has(one)) continue;
        frameA.multiplyMatrices(poseOf(one.joint.a)!, one.inA);
        frameB.multiplyMatrices(poseOf(one.joint.b)!, one.inB);
        const {frame, pointer} = stand(limit, one.joint, frameA, frameB);
        many.setMatrix(count++, matrix.copy(frame).scale(scale.setScalar(one.reach)));
        if (this.sparse) continue;
        anchorA.setFromMatrixPosition(frame);
        if (limit.kind === 'twist') anchorA.addScaledVector(direction.setFromMatrixColumn(frame, 2), 0.25 * one.reach);
        anchorB.copy(anchorA).addScaledVector(pointer, (limit.kind === 'twist' ? 0.5 : 1) * one.reach);
        this.rod(this.pointers, pointers++, anchorA, anchorB, 0.04 * one.size);
      }
      this.finish(many, count);
    }
    this.finish(this.pointers, pointers);
  }

  /** Limits at a frame's poses. */
  shownLimits(poseOf: (body: number) => THREE.Matrix4 | null): ShownLimit[] {
    return this.limits.flatMap(({joints}) => joints.flatMap(({one, limit}) => {
      const a = poseOf(one.joint.a), b = poseOf(one.joint.b);
      if (a === null || b === null) return [];
      frameA.multiplyMatrices(a, one.inA);
      frameB.multiplyMatrices(b, one.inB);
      return [{kind: limit.kind, low: limit.low, high: limit.high, ...reading(limit, stand(limit, one.joint, frameA, frameB))}];
    }));
  }

  private ball(many: Many, index: number, at: THREE.Vector3, radius: number): void {
    many.setMatrix(index, matrix.makeScale(radius, radius, radius).setPosition(at));
  }
  private rod(many: Many, index: number, from: THREE.Vector3, to: THREE.Vector3, radius: number): void {
    const way = to.clone().sub(from), length = way.length();
    turn.setFromUnitVectors(up, way.divideScalar(Math.max(length, 1e-12)));
    many.setMatrix(index, matrix.compose(middle.addVectors(from, to).multiplyScalar(0.5), turn, scale.set(radius, length, radius)));
  }
  private finish(many: Many, count: number): void {
    many.setCount(count);
    if (count > 0) many.update();
  }

  dispose(): void {
    for (const many of this.all()) many.dispose();
  }
}
