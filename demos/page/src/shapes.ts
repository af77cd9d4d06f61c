// Geometries of recorded shapes, in the frame of their body.

import * as THREE from 'three';
import {RoundedBoxGeometry} from 'three/examples/jsm/geometries/RoundedBoxGeometry.js';
import {mergeGeometries} from 'three/examples/jsm/utils/BufferGeometryUtils.js';

import type {Shape, Vec} from './data';

const up = new THREE.Vector3(0, 1, 0);
const axes = [new THREE.Vector3(1, 0, 0), up, new THREE.Vector3(0, 0, 1)];

// three's own stand along y.
function along(geometry: THREE.BufferGeometry, axis: number): THREE.BufferGeometry {
  const q = new THREE.Quaternion().setFromUnitVectors(up, axes[axis] ?? up);
  return geometry.applyQuaternion(q);
}

function box(half: Vec, at: Vec | undefined, fine: boolean): THREE.BufferGeometry {
  const size = half.map((h) => Math.max(2 * h, 1e-4)) as Vec;
  const radius = 0.08 * Math.min(...size);
  const geometry = fine ? new RoundedBoxGeometry(...size, 1, radius) : new THREE.BoxGeometry(...size);
  if (at !== undefined) geometry.translate(...at);
  return geometry;
}

function mesh(points: Float32Array, triangles: Float32Array): THREE.BufferGeometry {
  // Faces are flat: no vertex is shared.
  const position = new Float32Array(3 * triangles.length);
  triangles.forEach((vertex, i) => position.set(points.subarray(3 * vertex, 3 * vertex + 3), 3 * i));
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(position, 3));
  geometry.computeVertexNormals();
  return geometry;
}

function merged(parts: THREE.BufferGeometry[]): THREE.BufferGeometry | null {
  const plain = parts.map((part) => {
    const open = part.index === null ? part : part.toNonIndexed();
    for (const name of Object.keys(open.attributes)) {
      if (name !== 'position' && name !== 'normal') open.deleteAttribute(name);
    }
    return open;
  });
  return plain.length > 0 ? mergeGeometries(plain) : null;
}

/** 4: with round edges, where few are drawn; 1: as few faces as tell the shape. */
export type Detail = 1 | 2 | 3 | 4;

/** Null: it is not drawn (a plane is the floor's). */
export function geometryOf(shape: Shape, detail: Detail): THREE.BufferGeometry | null {
  const fine = detail === 4, round = [6, 8, 12, 32][detail - 1]!;
  switch (shape.kind) {
    case 'box': return box(shape.half, shape.at, fine);
    case 'sphere': return new THREE.SphereGeometry(shape.radius, round, round / 2);
    case 'capsule':
      return along(new THREE.CapsuleGeometry(shape.radius, 2 * shape.half, [1, 1, 2, 8][detail - 1]!, [5, 6, 8, 20][detail - 1]!), shape.axis);
    case 'cylinder': {
      const {radius, half} = shape, plain = new THREE.CylinderGeometry(radius, radius, 2 * half, round);
      if (detail < 3) return along(plain, shape.axis);
      // A bar across its ends shows that it turns.
      const bar = new THREE.BoxGeometry(1.6 * radius, 2 * half + 0.06 * radius, 0.18 * radius);
      return along(merged([plain, bar])!, shape.axis);
    }
    case 'cone': return along(new THREE.ConeGeometry(shape.radius, 2 * shape.half, round), shape.axis);
    case 'mesh': return mesh(shape.points, shape.triangles);
    case 'compound': {
      const parts: THREE.BufferGeometry[] = [];
      for (const part of shape.parts) {
        const geometry = geometryOf(part.shape, detail);
        if (geometry === null) continue;
        const [x, y, z, qx, qy, qz, qw] = part.pose as [number, number, number, number, number, number, number];
        geometry.applyQuaternion(new THREE.Quaternion(qx, qy, qz, qw)).translate(x, y, z);
        parts.push(geometry);
      }
      return merged(parts);
    }
    case 'plane':
    case 'none': return null;
  }
}

/** The distance from the body's origin to its farthest point. */
export function radiusOf(shape: Shape): number {
  switch (shape.kind) {
    case 'box': return Math.hypot(...shape.half);
    case 'sphere': return shape.radius;
    case 'capsule': return shape.half + shape.radius;
    case 'cylinder':
    case 'cone': return Math.hypot(shape.half, shape.radius);
    case 'mesh': {
      let most = 0;
      for (let i = 0; i + 2 < shape.points.length; i += 3)
        most = Math.max(most, Math.hypot(shape.points[i]!, shape.points[i + 1]!, shape.points[i + 2]!));
      return most;
    }
    case 'compound':
      return Math.max(0, ...shape.parts.map((part) => Math.hypot(...part.pose.slice(0, 3)) + radiusOf(part.shape)));
    case 'plane':
    case 'none': return 0;
  }
}
