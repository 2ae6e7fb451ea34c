/** Models of gauges and valves, drawn as one instanced mesh for each kind. */

import { Color, Group, InstancedMesh, Matrix4, MeshLambertMaterial, DoubleSide } from "three";

import { fetchFile } from "../api/client";
import type { World, WorldCheckpoint } from "../api/types";
import { merged, wholeModel } from "./geometry";
import { type GlbNode, type GlbPart, readGlb } from "./glb";
import type { Stage } from "./stage";

/** Scale factor of the models, which would be too small to see. */
const LARGER = 1.6;
const FACE = [0.85, 0.86, 0.84] as const;
/** Strength of a tint; the model's own colour remains visible. */
const TINT = 0.45;

/** Colour the face of a gauge, which is its foremost part. The model has no textures, so it would be dark. */
function withFace(nodes: readonly GlbNode[]): GlbNode[] {
  const front = (part: GlbPart) => part.positions.reduce((most, x, i) => (i % 3 === 0 ? Math.max(most, x) : most), -Infinity);
  const [body, ...others] = nodes;
  if (body === undefined) return [];
  const foremost = Math.max(...body.parts.map(front));
  const parts = body.parts.map((part) => (front(part) === foremost ? { ...part, colour: FACE } : part));
  return [{ ...body, parts }, ...others];
}

export class Gauges {
  private readonly group = new Group();
  private readonly material = new MeshLambertMaterial({ vertexColors: true, flatShading: true, side: DoubleSide });
  private readonly kinds: { readonly mesh: InstancedMesh; readonly all: readonly WorldCheckpoint[] }[] = [];
  private tints = new Map<number, string>();

  constructor(private readonly stage: Stage) {
    stage.scene.add(this.group);
  }

  /** Load the kinds that the site has. Throws `Unreached`. */
  async load(site: World, cancelled: () => boolean): Promise<void> {
    const kinds = [...new Set(site.checkpoints.map((one) => one.kind))];
    const found = await Promise.all(
      kinds.map((kind) => fetchFile(`/api/world/checkpoints/${encodeURIComponent(kind)}`)),
    );
    if (cancelled()) return;
    this.clear();
    kinds.forEach((kind, index) => {
      const nodes = readGlb(found[index] as ArrayBuffer);
      const geometry = merged(wholeModel(kind === "valve" ? nodes : withFace(nodes)));
      const all = site.checkpoints.filter((one) => one.kind === kind);
      const mesh = new InstancedMesh(geometry, this.material, all.length);
      mesh.frustumCulled = false;
      all.forEach((_, i) => mesh.setColorAt(i, new Color("#ffffff")));
      this.kinds.push({ mesh, all });
      this.group.add(mesh);
    });
    this.tints = new Map();
  }

  /** Draw the models on shown floors. */
  show(isShown: (floor: number) => boolean): void {
    const place = new Matrix4();
    for (const { mesh, all } of this.kinds) {
      all.forEach((one, i) => {
        const size = isShown(one.floor) ? LARGER : 0;
        place.makeRotationZ(one.facing).setPosition(...one.position);
        mesh.setMatrixAt(i, place.multiply(new Matrix4().makeScale(size, size, size)));
      });
      mesh.instanceMatrix.needsUpdate = true;
    }
    this.stage.need();
  }

  /** Tint some models by their id; unchanged ones are not touched. */
  tint(tints: ReadonlyMap<number, string>): void {
    for (const { mesh, all } of this.kinds)
      all.forEach((one, i) => {
        const wanted = tints.get(one.id);
        if (wanted === this.tints.get(one.id)) return;
        mesh.setColorAt(i, new Color("#ffffff").lerp(new Color(wanted ?? "#ffffff"), TINT));
        if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
      });
    this.tints = new Map(tints);
    this.stage.need();
  }

  dispose(): void {
    this.clear();
    this.material.dispose();
    this.group.removeFromParent();
  }

  private clear(): void {
    for (const { mesh } of this.kinds) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
      mesh.dispose();
    }
    this.kinds.length = 0;
  }
}
