/** The chosen faults in the scene: their sizes where they have one, and the click that gives one its place. */

import { effect, signal } from "@preact/signals-core";
import { Group, Mesh, MeshLambertMaterial, SphereGeometry, type Vector3 } from "three";

import { markPoint, type FaultDraft } from "../model/faults";
import { floorOf } from "../model/standing-map";
import { faultDescriptions, faultsOf, placeFault, placingFault, placingForm, shownFaultList } from "../state/faults";
import { shownFloor } from "../state/view";
import { world } from "../state/world";
import { colours } from "./colours";
import { box } from "./ground-marks";
import { dispose } from "./stage";
import type { SceneView } from "./view";

/** m: height of a drawn area */
const FLAT = 0.04;
/** The point under the pointer while the second corner of an area is chosen. */
const pointed = signal<Vector3 | null>(null);

/** Follow the pointer with the second corner of an area. */
export function pointFault(view: SceneView, x: number, y: number): void {
  pointed.value = placingFault.value?.corner ? (view.site.hitWays(view.rayAt(x, y))?.point ?? null) : null;
}

/** Give the fault its place at a point of the view (px): on the ground, on a surface, or at a checkpoint. */
export function clickFault(view: SceneView, x: number, y: number): void {
  const form = placingForm.value;
  const mark = form === "point" || form === "checkpoint" ? view.markAt(x, y) : null;
  const checkpoint = mark?.subject.kind === "checkpoint" ? mark.subject.checkpoint : null;
  const ray = view.rayAt(x, y);
  const point = form === "point" ? view.site.hitSolids(ray)?.point : view.site.hitWays(ray)?.point;
  if (checkpoint !== null) placeFault({ point: checkpoint.position, checkpoint: checkpoint.id });
  else if (point) placeFault({ point: [point.x, point.y, point.z], checkpoint: null });
  pointed.value = null;
}

export class FaultsView {
  private readonly group = new Group();
  private readonly stop: () => void;

  constructor(private readonly view: SceneView) {
    view.stage.scene.add(this.group);
    this.stop = effect(() => this.draw());
  }

  dispose(): void {
    this.stop();
    dispose(this.group);
  }

  private draw(): void {
    for (const one of [...this.group.children]) dispose(one);
    const site = world.value;
    const list = shownFaultList.value;
    const highest = shownFloor.value;
    if (site !== null && list !== null)
      for (const fault of faultsOf(list)) {
        const point = markPoint(fault, site);
        if (point === null || (floorOf(site.floors, point[2])?.number ?? 1) > (highest ?? Infinity)) continue;
        const mesh = meshOf(fault, point, colours.value.bad);
        if (mesh !== null) this.group.add(mesh);
      }
    const corner = placingFault.value?.corner;
    const other = pointed.value;
    if (corner && other) this.group.add(area([corner[0], corner[1], other.x, other.y], corner[2], colours.value.warn));
    this.view.stage.need();
  }
}

/** Return the mesh of a fault that has a size; null: its mark is enough. */
function meshOf(fault: FaultDraft, [x, y, z]: readonly [number, number, number], colour: string): Mesh | null {
  const fields = faultDescriptions.value.get(fault.kind)?.fields ?? [];
  const valueOf = (name: string) => fault[name] ?? fields.find((field) => field.name === name)?.default;
  const [size, rect, radius] = [valueOf("size"), valueOf("rect"), valueOf("radius")];
  if (Array.isArray(rect)) return area(rect as readonly number[], z, colour);
  if (Array.isArray(size)) {
    const yaw = typeof fault["yaw"] === "number" ? (fault["yaw"] * Math.PI) / 180 : 0;
    return box({ x, y, z, yaw }, size as readonly number[], colour, 0.8);
  }
  if (typeof radius !== "number") return null;
  const mesh = new Mesh(
    new SphereGeometry(radius, 24, 16),
    new MeshLambertMaterial({ color: colour, transparent: true, opacity: 0.6 }),
  );
  mesh.position.set(x, y, z);
  return mesh;
}

function area([x0 = 0, y0 = 0, x1 = 0, y1 = 0]: readonly number[], z: number, colour: string): Mesh {
  const pose = { x: (x0 + x1) / 2, y: (y0 + y1) / 2, z, yaw: 0 };
  return box(pose, [Math.abs(x1 - x0), Math.abs(y1 - y0), FLAT], colour, 0.6);
}
