// Limits of joints as they are drawn: arcs, wedges and cones of unit length in a frame of their own, and what in it shows
// where the joint is now. The maths of recorded limits (plugin/pintle/record/constraints.h) is here alone.

import * as THREE from 'three';

import type {Joint, Limit} from './data';

// A fan of directions about a centre, of unit length.
function fan(directions: THREE.Vector3[], closed: boolean): THREE.BufferGeometry {
  const points: number[] = [];
  const last = closed ? directions.length : directions.length - 1;
  for (let i = 0; i < last; ++i) {
    const from = directions[i]!, to = directions[(i + 1) % directions.length]!;
    points.push(0, 0, 0, from.x, from.y, from.z, to.x, to.y, to.z);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(points, 3));
  return geometry;
}

// About z, from x.
function arc(low: number, high: number): THREE.BufferGeometry {
  const directions: THREE.Vector3[] = [];
  const steps = Math.max(2, Math.ceil(Math.abs(high - low) / 0.12));
  // What spans more than a turn is a spiral, so that its turns are told apart.
  const turns = (high - low) / (2 * Math.PI);
  for (let i = 0; i <= steps; ++i) {
    const part = i / steps, angle = low + part * (high - low);
    const radius = turns > 1 ? 0.55 + 0.45 * part : 1;
    directions.push(new THREE.Vector3(radius * Math.cos(angle), radius * Math.sin(angle), 0));
  }
  return fan(directions, false);
}

// Two half discs about z, and the way between them.
function wedge(low: number, high: number): THREE.BufferGeometry {
  const sides = [low, high].map((angle) => {
    const directions: THREE.Vector3[] = [];
    for (let i = 0; i <= 16; ++i) {
      const tilt = Math.PI * (i / 16 - 0.5), across = Math.cos(tilt);
      directions.push(new THREE.Vector3(across * Math.cos(angle), across * Math.sin(angle), Math.sin(tilt)));
    }
    return fan(directions, false);
  });
  return merge([arc(low, high), ...sides]);
}

function merge(parts: THREE.BufferGeometry[]): THREE.BufferGeometry {
  const points = parts.flatMap((part) => Array.from(part.getAttribute('position').array));
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(points, 3));
  return geometry;
}

// Of half angles about y and z, elliptic in the swing's rotation vector.
const span = (y: number, z: number, aboutY: number, aboutZ: number): number =>
  Math.min(Math.PI, 1 / Math.hypot(y / Math.max(aboutY, 1e-3), z / Math.max(aboutZ, 1e-3)));

// About x.
function cone(aboutY: number, aboutZ: number): THREE.BufferGeometry {
  const directions: THREE.Vector3[] = [];
  for (let i = 0; i < 40; ++i) {
    const angle = (2 * Math.PI * i) / 40, y = Math.cos(angle), z = Math.sin(angle);
    directions.push(new THREE.Vector3(1, 0, 0).applyAxisAngle(new THREE.Vector3(0, y, z), span(y, z, aboutY, aboutZ)));
  }
  return fan(directions, true);
}

/** Null: it is not drawn as a surface (in metres, by lines), or it is no limit. */
export function limitGeometry(limit: Limit): THREE.BufferGeometry | null {
  switch (limit.kind) {
    case 'angle':
    case 'turn': return arc(limit.low, limit.high);
    case 'wedge': return wedge(limit.low, limit.high);
    case 'twist': return arc(limit.low, limit.high).scale(0.5, 0.5, 0.5).translate(0, 0, 0.25);
    case 'cone': return limit.low >= Math.PI && limit.high >= Math.PI ? null : cone(limit.low, limit.high);
    case 'bend': return cone(limit.high, limit.high);
    case 'slide':
    case 'distance': return null;
  }
}

const column = (of: THREE.Matrix4, i: number): THREE.Vector3 => new THREE.Vector3().setFromMatrixColumn(of, i);
const noRow = new THREE.Vector3();

// Right-handed: x, and z across it.
function frameOf(x: THREE.Vector3, z: THREE.Vector3, at: THREE.Matrix4): THREE.Matrix4 {
  return new THREE.Matrix4().makeBasis(x, noRow.crossVectors(z, x), z).copyPosition(at);
}

/** Where a limit stands, and the direction in it that it limits; a and b are the joint's frames in the world. */
export interface Stand {
  frame: THREE.Matrix4;
  pointer: THREE.Vector3;  // of the world
}

export function stand(limit: Limit, joint: Joint, a: THREE.Matrix4, b: THREE.Matrix4): Stand {
  switch (limit.kind) {
    case 'cone': return {frame: b, pointer: column(a, 0)};
    case 'twist': {
      // What is left of the turn of a against b after the swing.
      const turn = new THREE.Quaternion().setFromRotationMatrix(b.clone().invert().multiply(a));
      const twist = 2 * Math.atan2(turn.x, turn.w);
      const pointer = column(b, 1).multiplyScalar(Math.cos(twist)).addScaledVector(column(b, 2), Math.sin(twist));
      return {frame: frameOf(column(b, 1), column(b, 0), b), pointer};
    }
    case 'turn': return standOfTurn(limit.axis, joint, a, b);
    default: return {frame: a, pointer: column(b, 0)};
  }
}

// Bullet's three angles: about the first axis of a, the last one of b, and what is across both. Those about the first
// and the second are left-handed; that about the last is, too, of b against a, and is drawn in b.
function standOfTurn(axis: number, joint: Joint, a: THREE.Matrix4, b: THREE.Matrix4): Stand {
  const [last, second, first] = joint.order ?? [0, 1, 2];
  const sign = (last! + 1) % 3 === second ? 1 : -1;
  const about = column(a, first!), end = column(b, last!);
  const across = joint.align === 'across' ? column(b, second!) : about.clone().cross(end).multiplyScalar(sign).normalize();
  const middle = across.clone().cross(about).multiplyScalar(sign);  // the last axis after the first turn
  if (axis === first) return {frame: frameOf(column(a, last!), about.negate(), a), pointer: middle};
  if (axis === second) return {frame: frameOf(middle, across.negate(), a), pointer: end};
  return {frame: frameOf(column(b, second!), end, b), pointer: across};
}

/** What the pointer shows (rad), and how far that is beyond the limit. */
export function reading(limit: Limit, {frame, pointer}: Stand): {at: number; beyond: number} {
  const local = pointer.clone().transformDirection(frame.clone().invert());
  const across = Math.hypot(local.y, local.z), swing = Math.atan2(across, local.x);
  const outside = (at: number): number => Math.max(0, limit.low - at, at - limit.high);
  switch (limit.kind) {
    case 'bend': return {at: swing, beyond: outside(swing)};
    case 'cone': {
      // The swing's axis is x cross the pointer.
      const most = across === 0 ? Infinity : span(-local.z / across, local.y / across, limit.low, limit.high);
      return {at: swing, beyond: Math.max(0, swing - most)};
    }
    default: {
      const at = Math.atan2(local.y, local.x);
      return {at, beyond: Math.min(...[-1, 0, 1].map((turns) => outside(at + 2 * Math.PI * turns)))};
    }
  }
}
