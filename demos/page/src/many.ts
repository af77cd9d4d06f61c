// Many bodies in one draw: their geometries as one, each vertex with the number of its body, whose pose and colour are
// read from a texture. (Renderers in software draw instances one by one, which takes a hundred times as long.) Where all is
// drawn in software, the corners are posed here: there a shader takes longer to read a texture than to draw.

import * as THREE from 'three';
import {mergeVertices} from 'three/examples/jsm/utils/BufferGeometryUtils.js';

const perRow = 256;   // bodies in a row of the texture
const texels = 4;     // of a body: three rows of its matrix, and its colour
const maxVertices = 4e6;

export const sun = new THREE.Vector3(-0.45, -0.75, 1.35).normalize();  // where it stands
const inShader = (vector: THREE.Vector3): string => `vec3(${vector.toArray().map((value) => value.toFixed(4)).join(', ')})`;

const declarations = `
attribute float many;
uniform highp sampler2D manyData;
ivec2 manyAt() { int i = int(many + 0.5); return ivec2((i % ${perRow}) * ${texels}, i / ${perRow}); }
vec3 manyTurn(vec3 v) {
  ivec2 at = manyAt();
  return vec3(dot(texelFetch(manyData, at, 0).xyz, v), dot(texelFetch(manyData, at + ivec2(1, 0), 0).xyz, v),
              dot(texelFetch(manyData, at + ivec2(2, 0), 0).xyz, v));
}
vec3 manyMove(vec3 p) {
  ivec2 at = manyAt();
  return vec3(dot(texelFetch(manyData, at, 0), vec4(p, 1.0)), dot(texelFetch(manyData, at + ivec2(1, 0), 0), vec4(p, 1.0)),
              dot(texelFetch(manyData, at + ivec2(2, 0), 0), vec4(p, 1.0)));
}
`;

// Poses a vertex before all that three does with it; without a texture it is posed already.
function posed<M extends THREE.Material>(material: M, data: THREE.DataTexture | null, coloured: boolean): M {
  if (data === null) return material;
  material.onBeforeCompile = (shader) => {
    shader.uniforms['manyData'] = {value: data};
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', `#include <common>${declarations}${coloured ? 'varying vec3 manyColour;' : ''}`)
      .replace('#include <beginnormal_vertex>', 'vec3 objectNormal = manyTurn(normal);')
      .replace('#include <begin_vertex>', `vec3 transformed = manyMove(position);
        ${coloured ? 'manyColour = texelFetch(manyData, manyAt() + ivec2(3, 0), 0).rgb;' : ''}`);
    if (coloured) {
      shader.fragmentShader = shader.fragmentShader
        .replace('#include <common>', '#include <common>\nvarying vec3 manyColour;')
        .replace('#include <color_fragment>', 'diffuseColor.rgb *= manyColour;');
    }
  };
  material.customProgramCacheKey = () => `many ${coloured} ${material.type}`;
  return material;
}

/** Lit at the vertices, for renderers in software: a pixel costs next to nothing. For corners that are posed here. */
export const plainMaterial = (): THREE.ShaderMaterial => new THREE.ShaderMaterial({
  vertexShader: `
    attribute vec3 bodyColour;
    varying vec3 lit;
    void main() {
      float above = 0.5 + 0.5 * normal.z;
      float sun = max(0.0, dot(normal, ${inShader(sun)}));
      lit = sqrt(bodyColour * (0.30 + 0.22 * above + 0.62 * sun));
      gl_Position = projectionMatrix * (viewMatrix * vec4(position, 1.0));
    }`,
  fragmentShader: 'varying vec3 lit;\nvoid main() { gl_FragColor = vec4(lit, 1.0); }',
});

/** Bodies pressed flat onto a plane, away from the sun. */
export const flatMaterial = ({normal, constant}: THREE.Plane): THREE.ShaderMaterial => new THREE.ShaderMaterial({
  uniforms: {plane: {value: new THREE.Vector4(...normal, constant)}, colour: {value: new THREE.Color()}},
  vertexShader: `
    uniform vec4 plane;
    void main() {
      vec3 sun = ${inShader(sun.clone().divideScalar(sun.z))};
      float way = max(0.0, dot(plane, vec4(position, 1.0))) / max(0.1, dot(plane.xyz, sun));
      gl_Position = projectionMatrix * (viewMatrix * vec4(position - way * sun, 1.0));
    }`,
  fragmentShader: 'uniform vec3 colour;\nvoid main() { gl_FragColor = vec4(colour, 1.0); }',
  polygonOffset: true,
  polygonOffsetFactor: -2,
  polygonOffsetUnits: -2,
});

export class Many {
  readonly mesh: THREE.Mesh;
  private readonly data: Float32Array;
  private readonly texture: THREE.DataTexture | null = null;
  private readonly size: number;  // corners of a body, if all have the same geometry
  // Where the corners are posed here: as they are in their bodies, and where each body's begin.
  private readonly corners: Float32Array;
  private readonly normals: Float32Array;
  private readonly start: Int32Array;
  private shown: number;  // so many are drawn

  /** Body i has geometries[i], or all have one. `coloured`: each has its own colour. `plain`: for a renderer in software. */
  constructor(geometries: THREE.BufferGeometry[] | THREE.BufferGeometry, readonly capacity: number,
              material: THREE.Material, coloured: boolean, private readonly plain: boolean) {
    const rows = Math.max(1, Math.ceil(capacity / perRow));
    this.shown = capacity;
    this.data = new Float32Array(plain ? 0 : 4 * texels * perRow * rows);
    if (!plain) this.texture = new THREE.DataTexture(this.data, texels * perRow, rows, THREE.RGBAFormat, THREE.FloatType);

    const indexed = new Map<THREE.BufferGeometry, THREE.BufferGeometry>();
    const of = (i: number): THREE.BufferGeometry => {
      const geometry = Array.isArray(geometries) ? geometries[i]! : geometries;
      let own = indexed.get(geometry);
      if (own === undefined) {
        own = geometry.clone();
        for (const name of Object.keys(own.attributes)) {
          if (name !== 'position' && !(name === 'normal' && coloured)) own.deleteAttribute(name);
        }
        own = mergeVertices(own, 1e-6);
        indexed.set(geometry, own);
      }
      return own;
    };
    let vertices = 0, corners = 0, count = 0;
    for (; count < capacity; ++count) {
      const more = of(count).getAttribute('position').count;
      if (vertices + more > maxVertices) break;
      vertices += more;
      corners += of(count).index!.count;
    }
    this.size = count > 0 ? of(0).index!.count : 0;
    const position = new Float32Array(3 * vertices), normal = new Float32Array(3 * vertices), body = new Float32Array(vertices),
          index = new Uint32Array(corners);
    this.start = new Int32Array(capacity + 1).fill(vertices);
    for (let i = 0, at = 0, corner = 0; i < count; ++i) {
      const geometry = of(i), points = geometry.getAttribute('position'), normals = geometry.getAttribute('normal');
      position.set(points.array as Float32Array, 3 * at);
      if (normals !== undefined) normal.set(normals.array as Float32Array, 3 * at);
      this.start[i] = at;
      body.fill(i, at, at + points.count);
      for (const vertex of geometry.index!.array) index[corner++] = at + vertex;
      at += points.count;
    }
    const geometry = new THREE.BufferGeometry();
    this.corners = plain ? position.slice() : position;
    this.normals = plain ? normal.slice() : normal;
    const moving = plain ? THREE.DynamicDrawUsage : THREE.StaticDrawUsage;
    geometry.setAttribute('position', new THREE.BufferAttribute(position, 3).setUsage(moving));
    if (coloured) geometry.setAttribute('normal', new THREE.BufferAttribute(normal, 3).setUsage(moving));
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    if (!plain) geometry.setAttribute('many', new THREE.BufferAttribute(body, 1));
    else if (coloured) geometry.setAttribute('bodyColour', new THREE.BufferAttribute(new Float32Array(3 * vertices), 3));
    this.mesh = new THREE.Mesh(geometry, posed(material, this.texture, coloured));
    if (!plain) this.mesh.customDepthMaterial = posed(new THREE.MeshDepthMaterial({depthPacking: THREE.RGBADepthPacking}), this.texture, false);
    this.mesh.frustumCulled = false;
  }

  /** Null: it is not drawn. */
  setMatrix(index: number, matrix: THREE.Matrix4 | null): void {
    if (this.plain) return this.pose(index, matrix);
    const at = this.place(index);
    if (matrix === null) {
      this.data.fill(0, at, at + 12);
      return;
    }
    const from = matrix.elements;
    for (let row = 0; row < 3; ++row) {
      for (let column = 0; column < 4; ++column) this.data[at + 4 * row + column] = from[4 * column + row]!;
    }
  }
  setColour(index: number, colour: THREE.Color): void {
    if (!this.plain) {
      this.data.set([colour.r, colour.g, colour.b], this.place(index) + 12);
      return;
    }
    const colours = this.mesh.geometry.getAttribute('bodyColour');
    for (let i = this.start[index]!; i < this.start[index + 1]!; ++i) colours.setXYZ(i, colour.r, colour.g, colour.b);
    colours.needsUpdate = true;
  }

  // As the shader would.
  private pose(index: number, matrix: THREE.Matrix4 | null): void {
    const {geometry} = this.mesh, to = geometry.getAttribute('position').array;
    const first = 3 * this.start[index]!, end = 3 * this.start[index + 1]!;
    if (matrix === null) {
      to.fill(0, first, end);
      return;
    }
    const m = matrix.elements, {corners, normals} = this;
    for (let i = first; i < end; i += 3) {
      const x = corners[i]!, y = corners[i + 1]!, z = corners[i + 2]!;
      to[i] = m[0]! * x + m[4]! * y + m[8]! * z + m[12]!;
      to[i + 1] = m[1]! * x + m[5]! * y + m[9]! * z + m[13]!;
      to[i + 2] = m[2]! * x + m[6]! * y + m[10]! * z + m[14]!;
    }
    const turned = geometry.attributes['normal']?.array;
    if (turned === undefined) return;
    for (let i = first; i < end; i += 3) {
      const x = normals[i]!, y = normals[i + 1]!, z = normals[i + 2]!;
      turned[i] = m[0]! * x + m[4]! * y + m[8]! * z;
      turned[i + 1] = m[1]! * x + m[5]! * y + m[9]! * z;
      turned[i + 2] = m[2]! * x + m[6]! * y + m[10]! * z;
    }
  }
  /** Of those with one geometry: so many are drawn, the first ones. */
  setCount(count: number): void {
    this.shown = count;
    this.mesh.visible = count > 0;
    this.mesh.geometry.setDrawRange(0, count * this.size);
  }
  /** After all that has been set. */
  update(): void {
    if (this.texture !== null) {
      this.texture.needsUpdate = true;
      return;
    }
    for (const name of ['position', 'normal']) {
      const attribute = this.mesh.geometry.attributes[name];
      if (attribute !== undefined) attribute.needsUpdate = true;
    }
  }

  /** The corners of each as they are drawn: x, y, z. For tests. */
  drawnCorners(): number[][] {
    const points = this.mesh.geometry.getAttribute('position').array;
    return Array.from({length: this.mesh.visible ? this.shown : 0}, (_, index) => {
      const corners = Array.from(points.subarray(3 * this.start[index]!, 3 * this.start[index + 1]!));
      if (this.plain) return corners;
      const at = this.place(index), m = this.data.subarray(at, at + 12);
      return corners.map((_value, i) => {
        const row = 4 * (i % 3), first = i - (i % 3);
        return m[row]! * corners[first]! + m[row + 1]! * corners[first + 1]! + m[row + 2]! * corners[first + 2]! + m[row + 3]!;
      });
    });
  }

  private place(index: number): number {
    return 4 * texels * index;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    (this.mesh.material as THREE.Material).dispose();
    this.mesh.customDepthMaterial?.dispose();
    this.texture?.dispose();
  }
}
