// Many bodies in one draw: their geometries as one, each vertex with the number of its body, whose pose and colour are
// read from a texture. (Renderers in software draw instances one by one, which takes a hundred times as long.)

import * as THREE from 'three';
import {mergeVertices} from 'three/examples/jsm/utils/BufferGeometryUtils.js';

const perRow = 256;   // bodies in a row of the texture
const texels = 4;     // of a body: three rows of its matrix, and its colour
const maxVertices = 4e6;

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

// Poses a vertex before all that three does with it.
function posed<M extends THREE.Material>(material: M, data: THREE.DataTexture, coloured: boolean): M {
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

/** Lit at the vertices, for renderers in software: a pixel costs next to nothing. */
export const plainMaterial = (): THREE.ShaderMaterial => new THREE.ShaderMaterial({
  vertexShader: `#include <common>
    varying vec3 lit;
    void main() {
      #include <beginnormal_vertex>
      #include <begin_vertex>
      float above = 0.5 + 0.5 * normalize(objectNormal).z;
      float sun = max(0.0, dot(normalize(objectNormal), vec3(-0.28, -0.47, 0.84)));
      lit = sqrt(manyColour * (0.30 + 0.22 * above + 0.62 * sun));
      gl_Position = projectionMatrix * viewMatrix * vec4(transformed, 1.0);
    }`,
  fragmentShader: '#include <common>\nvarying vec3 lit;\nvoid main() { gl_FragColor = vec4(lit, 1.0); }',
});

/** Bodies pressed flat onto the floor, away from the sun. */
export const flatMaterial = (floor: number): THREE.ShaderMaterial => new THREE.ShaderMaterial({
  uniforms: {floor: {value: floor}, colour: {value: new THREE.Color()}},
  vertexShader: `#include <common>
    uniform float floor;
    void main() {
      #include <begin_vertex>
      float height = max(0.0, transformed.z - floor);
      transformed = vec3(transformed.xy + height * vec2(0.33, 0.56), floor);
      gl_Position = projectionMatrix * viewMatrix * vec4(transformed, 1.0);
    }`,
  fragmentShader: 'uniform vec3 colour;\nvoid main() { gl_FragColor = vec4(colour, 1.0); }',
  polygonOffset: true,
  polygonOffsetFactor: -2,
  polygonOffsetUnits: -2,
});

export class Many {
  readonly mesh: THREE.Mesh;
  private readonly data: Float32Array;
  private readonly texture: THREE.DataTexture;
  private readonly size: number;  // corners of a body, if all have the same geometry

  /** Body i has geometries[i], or all have one. `coloured`: each has its own colour. */
  constructor(geometries: THREE.BufferGeometry[] | THREE.BufferGeometry, readonly capacity: number,
              material: THREE.Material, coloured: boolean) {
    const rows = Math.max(1, Math.ceil(capacity / perRow));
    this.data = new Float32Array(4 * texels * perRow * rows);
    this.texture = new THREE.DataTexture(this.data, texels * perRow, rows, THREE.RGBAFormat, THREE.FloatType);

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
    for (let i = 0, at = 0, corner = 0; i < count; ++i) {
      const geometry = of(i), points = geometry.getAttribute('position'), normals = geometry.getAttribute('normal');
      position.set(points.array as Float32Array, 3 * at);
      if (normals !== undefined) normal.set(normals.array as Float32Array, 3 * at);
      body.fill(i, at, at + points.count);
      for (const vertex of geometry.index!.array) index[corner++] = at + vertex;
      at += points.count;
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(position, 3));
    geometry.setAttribute('normal', new THREE.BufferAttribute(normal, 3));
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    geometry.setAttribute('many', new THREE.BufferAttribute(body, 1));
    this.mesh = new THREE.Mesh(geometry, posed(material, this.texture, coloured));
    this.mesh.customDepthMaterial = posed(new THREE.MeshDepthMaterial({depthPacking: THREE.RGBADepthPacking}), this.texture, false);
    this.mesh.frustumCulled = false;
  }

  /** Null: it is not drawn. */
  setMatrix(index: number, matrix: THREE.Matrix4 | null): void {
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
    this.data.set([colour.r, colour.g, colour.b], this.place(index) + 12);
  }
  /** Of those with one geometry: so many are drawn, the first ones. */
  setCount(count: number): void {
    this.mesh.visible = count > 0;
    this.mesh.geometry.setDrawRange(0, count * this.size);
  }
  /** The same bodies once more, of another material. */
  again(material: THREE.Material): THREE.Mesh {
    const mesh = new THREE.Mesh(this.mesh.geometry, posed(material, this.texture, false));
    mesh.frustumCulled = false;
    return mesh;
  }
  /** After all that has been set. */
  update(): void {
    this.texture.needsUpdate = true;
  }

  private place(index: number): number {
    return 4 * texels * index;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    (this.mesh.material as THREE.Material).dispose();
    this.mesh.customDepthMaterial?.dispose();
    this.texture.dispose();
  }
}
