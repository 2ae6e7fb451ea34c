/** Merging of triangles of several parts into one geometry, so that they are drawn at once. */

import { BufferAttribute, BufferGeometry, Matrix4, Quaternion, Vector3 } from "three";

import type { GlbNode, GlbPart } from "./glb";

/** A part and its transform. */
export interface PlacedPart {
  readonly part: GlbPart;
  readonly place?: Matrix4;
}

/** Merge parts into one geometry; each vertex has the colour of its part. */
export function merged(parts: readonly PlacedPart[]): BufferGeometry {
  const corners = parts.reduce((sum, { part }) => sum + part.positions.length, 0);
  const triangles = parts.reduce((sum, { part }) => sum + part.index.length, 0);
  const positions = new Float32Array(corners);
  const colours = new Uint8Array(corners);
  const index = corners / 3 > 65_535 ? new Uint32Array(triangles) : new Uint16Array(triangles);
  const corner = new Vector3();
  let [at, first] = [0, 0];
  for (const { part, place } of parts) {
    positions.set(part.positions, at);
    if (place)
      for (let i = at; i < at + part.positions.length; i += 3)
        corner.fromArray(positions, i).applyMatrix4(place).toArray(positions, i);
    for (let i = 0; i < part.positions.length; i++)
      colours[at + i] = Math.round(255 * (part.colour[i % 3] as number));
    const before = at / 3;
    for (let i = 0; i < part.index.length; i++) index[first + i] = before + (part.index[i] as number);
    at += part.positions.length;
    first += part.index.length;
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setAttribute("color", new BufferAttribute(colours, 3, true));
  geometry.setIndex(new BufferAttribute(index, 1));
  return geometry;
}

/** Return all parts of a model, with its joints as given. */
export function wholeModel(nodes: readonly GlbNode[]): PlacedPart[] {
  const places: Matrix4[] = [];
  const parts: PlacedPart[] = [];
  for (const node of nodes) {
    const own = new Matrix4().compose(
      new Vector3(...node.position),
      new Quaternion(...node.rotation),
      new Vector3(1, 1, 1),
    );
    const carrier = node.parent === null ? undefined : places[node.parent];
    const place = carrier ? own.premultiply(carrier) : own;
    places.push(place);
    for (const part of node.parts) parts.push({ part, place });
  }
  return parts;
}
