/** The paths of the mission, coloured by time. The leg under the pointer or of the selected task is highlighted. */

import { computed, effect } from "@preact/signals-core";
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  GreaterDepth,
  Group,
  Mesh,
  MeshBasicMaterial,
  SRGBColorSpace,
  Vector3,
} from "three";

import type { PreviewedMission } from "../api/types";
import { taskKey } from "../model/outline";
import { markedColour, timeColour } from "../model/path-colours";
import { arrows, ribbon, ribbonPaths, type RibbonPath, type Triangles } from "../model/ribbons";
import { floorOf } from "../model/standing-map";
import { selection } from "../state/plan";
import { comparedPreview, hoveredLeg, preview } from "../state/preview";
import { panel, shownFloor } from "../state/view";
import { world } from "../state/world";
import { colours } from "./colours";
import { dependOn } from "../state/depend-on";
import { pathsShown } from "./settings";
import { dispose } from "./stage";
import type { SceneView } from "./view";

/** m */
const [WIDTH, THIN, WIDE, ABOVE, ARROW, ARROWS] = [0.13, 0.06, 0.26, 0.07, 0.2, 1.6];
/** px within which the pointer hits a path */
const NEAR_PX = 7;

/** opacity of what is hidden */
const SHINING = 0.35;

type Paint = (t: number) => Color;

export class PathsView {
  private readonly group = new Group();
  private readonly marked = new Group();
  private readonly compared = new Group();
  private readonly stops: (() => void)[];

  /** The paths with their ribbons, and the end time of the mission. */
  private readonly paths = computed(() => pathsOf(preview.value));
  /** The highlighted paths. */
  private readonly meant = computed(() => {
    const found = new Set<number>();
    if (hoveredLeg.value !== null) found.add(hoveredLeg.value);
    else
      preview.value?.ways.forEach(({ kind, target }, way) => {
        if (kind === "default" && selection.value.includes(taskKey(target))) found.add(way);
      });
    return found;
  });

  constructor(private readonly view: SceneView) {
    view.stage.scene.add(this.group, this.marked, this.compared);
    this.stops = [
      effect(() => {
        const { paths, end } = this.paths.value;
        const grey = new Color(colours.value.dim);
        const byTime: Paint = (t) => timed(end > 0 ? t / end : 0);
        this.clear(this.group);
        this.draw(this.group, paths.filter((one) => !one.dashed), WIDTH, byTime, ABOVE);
        this.draw(this.group, paths.filter((one) => one.dashed), THIN, () => grey, ABOVE - 0.01);
      }),
      effect(() => {
        const other = new Color(colours.value.good);
        this.clear(this.compared);
        const { paths } = pathsOf(panel.value === "route" ? comparedPreview.value : null);
        this.draw(this.compared, paths.filter((one) => !one.dashed), WIDTH, () => other, ABOVE + 0.03);
      }),
      effect(() => {
        const mark = new Color(markedColour(colours.value.dark));
        this.clear(this.marked);
        const paths = this.paths.value.paths.filter((one) => this.meant.value.has(one.way));
        this.draw(this.marked, paths, WIDE, () => mark, ABOVE - 0.02);
      }),
      effect(() => {
        const highest = shownFloor.value;
        const on = pathsShown.value;
        dependOn(this.paths, this.meant, comparedPreview, panel, colours);
        for (const group of [this.group, this.marked, this.compared])
          for (const one of group.children)
            one.visible = on && (highest === null || (one.userData["floor"] as number) <= highest);
        view.stage.need();
      }),
    ];
  }

  /** Return the index of the path at a point of the view (px). */
  wayAt(x: number, y: number): number | null {
    if (!pathsShown.peek()) return null;
    const highest = shownFloor.peek();
    let [best, least] = [null as number | null, NEAR_PX];
    for (const path of this.paths.peek().paths)
      for (const sample of path.samples) {
        if (highest !== null && floorAt(sample.z) > highest) continue;
        const seen = this.view.project(sample);
        const away = seen === null ? Infinity : Math.hypot(seen.x - x, seen.y - y);
        if (away >= least || this.isBehind(sample)) continue;
        [best, least] = [path.way, away];
      }
    return best;
  }

  dispose(): void {
    for (const stop of this.stops) stop();
    for (const group of [this.group, this.marked, this.compared]) dispose(group);
  }

  private isBehind({ x, y, z }: { readonly x: number; readonly y: number; readonly z: number }): boolean {
    return this.view.site.isBetween(this.view.stage.camera.position, new Vector3(x, y, z + ABOVE), 0.3, true);
  }

  private draw(group: Group, paths: readonly RibbonPath[], width: number, paint: Paint, above: number): void {
    const ribbons = new Map<number, Triangles>();
    const heads = new Map<number, Triangles>();
    for (const path of paths) {
      ribbon(path, width, above, floorAt, ribbons);
      if (width >= WIDTH) arrows(path, (ARROW * width) / WIDTH, ARROWS, above + 0.01, floorAt, heads);
    }
    for (const parts of [ribbons, heads])
      for (const [floor, triangles] of parts) {
        const geometry = geometryOf(triangles, paint);
        for (const mesh of [new Mesh(geometry, material()), new Mesh(geometry, behindMaterial())]) {
          mesh.userData["floor"] = floor;
          group.add(mesh);
        }
      }
  }

  private clear(group: Group): void {
    for (const one of [...group.children]) dispose(one);
  }
}

function pathsOf(found: PreviewedMission | null): { readonly paths: readonly RibbonPath[]; readonly end: number } {
  let start = 0;
  const legs = (found?.ways ?? []).map(({ kind, way }, number) => {
    const leg = { way: number, points: way.points, start, dashed: kind !== "default" };
    if (kind === "default") start += way.time ?? 0;
    return leg;
  });
  return { paths: ribbonPaths(legs), end: start };
}

export function floorAt(z: number): number {
  return floorOf(world.peek()?.floors ?? [], z)?.number ?? 1;
}

function timed(share: number): Color {
  const [red, green, blue] = timeColour(share);
  return new Color().setRGB(red / 255, green / 255, blue / 255, SRGBColorSpace);
}

export function geometryOf({ corners, times }: Triangles, paint: Paint): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(corners), 3));
  const painted = new Float32Array(3 * times.length);
  times.forEach((t, i) => painted.set(paint(t).toArray(), 3 * i));
  geometry.setAttribute("color", new BufferAttribute(painted, 3));
  return geometry;
}

export function material(): MeshBasicMaterial {
  return new MeshBasicMaterial({
    vertexColors: true,
    side: DoubleSide,
    polygonOffset: true,
    polygonOffsetFactor: -2,
    polygonOffsetUnits: -2,
  });
}

/** Create the material of the parts of a path that something hides: they shine through. */
function behindMaterial(): MeshBasicMaterial {
  const shining = material();
  shining.depthFunc = GreaterDepth;
  shining.depthWrite = false;
  shining.transparent = true;
  shining.opacity = SHINING;
  return shining;
}
