/** The solids of the site by floor, and ray casts against the shown ones. */

import { DoubleSide, Group, Mesh, MeshLambertMaterial, Ray, Vector3 } from "three";
import { MeshBVH } from "three-mesh-bvh";

import { fetchFile } from "../api/client";
import type { World } from "../api/types";
import { merged } from "./geometry";
import { type GlbNode, readGlb } from "./glb";
import { dispose, type Stage } from "./stage";

/** Kinds of solids that can be hidden on all floors. */
export type Hideable = "railing" | "pipe" | "vessel" | "structure";
export const HIDEABLE: readonly Hideable[] = ["railing", "pipe", "vessel", "structure"];
type Layer = Hideable | "base";

/** Names of the solids that the robot can drive on. */
const DRIVEN_ON = new Set(["ground", "deck", "stair"]);
const AT_ONCE = 4;

interface Storey {
  readonly number: number;
  readonly group: Group;
  readonly layers: ReadonlyMap<Layer, Mesh>;
  readonly ways: MeshBVH;
  /** of the meshes of `layers`, built on first use */
  readonly solids: Map<Layer, MeshBVH>;
}

export interface Hit {
  readonly point: Vector3;
  readonly distance: number;
}

export class Site {
  readonly root = new Group();
  private storeys: readonly Storey[] = [];
  private hidden: ReadonlySet<Hideable> = new Set();
  private highest: number | null = null;
  private readonly material = new MeshLambertMaterial({
    vertexColors: true,
    flatShading: true,
    side: DoubleSide,
    shadowSide: DoubleSide,
  });

  constructor(private readonly stage: Stage) {
    stage.scene.add(this.root);
  }

  /** Load the floors of a site, the lowest first. Throws `Unreached`. */
  async load(site: World, cancelled: () => boolean): Promise<void> {
    const detail = site.floors.length > 8 ? "coarse" : "full";
    const waiting = site.floors.map((floor) => floor.number);
    const found: Storey[] = [];
    const work = async () => {
      for (let number = waiting.shift(); number !== undefined; number = waiting.shift()) {
        const content = await fetchFile(`/api/world/floors/${number}/mesh/${detail}`);
        if (cancelled()) return;
        found.push(this.storey(number, readGlb(content)));
      }
    };
    await Promise.all(Array.from({ length: AT_ONCE }, work));
    if (cancelled()) return;
    for (const storey of this.storeys) this.drop(storey);
    this.storeys = found.sort((a, b) => a.number - b.number);
    for (const storey of found) this.root.add(storey.group);
    this.show(this.highest, this.hidden);
  }

  /** Show the floors up to a number (null: all), without the hidden kinds. */
  show(highest: number | null, hidden: ReadonlySet<Hideable>): void {
    this.highest = highest;
    this.hidden = hidden;
    for (const storey of this.storeys) {
      storey.group.visible = this.isShown(storey.number);
      for (const [layer, mesh] of storey.layers) mesh.visible = layer === "base" || !hidden.has(layer);
    }
    this.stage.needShadows();
  }

  isShown(floor: number): boolean {
    return this.highest === null || floor <= this.highest;
  }

  /** Return the first drivable surface that a ray hits beyond a distance (m). */
  hitWays(ray: Ray, beyond = 0): Hit | null {
    let nearest: Hit | null = null;
    for (const storey of this.storeys) {
      if (!storey.group.visible) continue;
      const hit = storey.ways.raycastFirst(ray, DoubleSide, beyond);
      if (hit !== null && (nearest === null || hit.distance < nearest.distance))
        nearest = { point: hit.point, distance: hit.distance };
    }
    return nearest;
  }

  /** Return the first shown solid that a ray hits. */
  hitSolids(ray: Ray): Hit | null {
    let nearest = this.hitWays(ray);
    for (const storey of this.storeys) {
      if (!storey.group.visible) continue;
      for (const layer of storey.layers.keys()) {
        const hit = this.bvhOf(storey, layer)?.raycastFirst(ray, DoubleSide);
        if (hit && (nearest === null || hit.distance < nearest.distance)) nearest = { point: hit.point, distance: hit.distance };
      }
    }
    return nearest;
  }

  /** Return whether a shown solid lies between two points. Solids within `near` m of the second point may
   * belong to it, and don't count. */
  isBetween(from: Vector3, to: Vector3, near = 0.35, onlyWays = false): boolean {
    const far = from.distanceTo(to) - near;
    const ray = new Ray(from, to.clone().sub(from).normalize());
    return this.storeys.some(
      (storey) =>
        storey.group.visible &&
        (isHit(storey.ways, ray, far) ||
          (!onlyWays && [...storey.layers.keys()].some((layer) => this.hits(storey, layer, ray, far)))),
    );
  }

  dispose(): void {
    for (const storey of this.storeys) this.drop(storey);
    this.material.dispose();
    this.root.removeFromParent();
  }

  private hits(storey: Storey, layer: Layer, ray: Ray, far: number): boolean {
    const bvh = this.bvhOf(storey, layer);
    return bvh !== null && isHit(bvh, ray, far);
  }

  /** Return the triangles of a layer for ray casts; null: the layer is not shown. */
  private bvhOf(storey: Storey, layer: Layer): MeshBVH | null {
    const mesh = storey.layers.get(layer);
    if (mesh?.visible !== true) return null;
    let bvh = storey.solids.get(layer);
    if (bvh === undefined) {
      // An indirect BVH doesn't reorder the triangles of the drawn mesh.
      bvh = new MeshBVH(mesh.geometry, { indirect: true });
      storey.solids.set(layer, bvh);
    }
    return bvh;
  }

  private storey(number: number, nodes: readonly GlbNode[]): Storey {
    const group = new Group();
    const layers = new Map<Layer, Mesh>();
    const layerOf = (node: GlbNode): Layer => HIDEABLE.find((one) => one === node.name) ?? "base";
    for (const layer of ["base", ...HIDEABLE] as const) {
      const parts = nodes.filter((node) => layerOf(node) === layer).flatMap((node) => node.parts);
      if (parts.length === 0) continue;
      const mesh = new Mesh(merged(parts.map((part) => ({ part }))), this.material);
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.matrixAutoUpdate = false;
      layers.set(layer, mesh);
      group.add(mesh);
    }
    const ways = nodes.filter((node) => DRIVEN_ON.has(node.name)).flatMap((node) => node.parts);
    const geometry = merged(ways.map((part) => ({ part })));
    return { number, group, layers, ways: new MeshBVH(geometry), solids: new Map() };
  }

  private drop(storey: Storey): void {
    storey.ways.geometry.dispose();
    dispose(storey.group);
  }
}

function isHit(bvh: MeshBVH, ray: Ray, far: number): boolean {
  return bvh.raycastFirst(ray, DoubleSide, 0, far) !== null;
}
