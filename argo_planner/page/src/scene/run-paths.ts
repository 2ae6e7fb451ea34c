/** The paths of two compared runs: a wide band for the first run, and a narrow line on top of it for the second. */

import { effect } from "@preact/signals-core";
import { Color, Group, Mesh } from "three";

import type { Entry } from "../api/types";
import { ribbon, ribbonPaths, type WayPoint } from "../model/ribbons";
import { comparedRuns } from "../state/compared-runs";
import { shownFloor } from "../state/view";
import { colours } from "./colours";
import { floorAt, geometryOf, material } from "./paths-view";
import { dispose } from "./stage";
import type { SceneView } from "./view";

/** m: width of the ribbons, and their height above the ground and the mission's paths */
const LOOKS = [
  { width: 0.34, above: 0.12 },
  { width: 0.12, above: 0.16 },
] as const;

export class RunPathsView {
  private readonly group = new Group();
  private readonly stops: (() => void)[];

  constructor(private readonly view: SceneView) {
    view.stage.scene.add(this.group);
    this.stops = [
      effect(() => this.draw()),
      effect(() => {
        const highest = shownFloor.value;
        for (const one of this.group.children)
          one.visible = highest === null || (one.userData["floor"] as number) <= highest;
        view.stage.need();
      }),
    ];
  }

  dispose(): void {
    for (const stop of this.stops) stop();
    dispose(this.group);
  }

  private draw(): void {
    for (const one of [...this.group.children]) dispose(one);
    const tones = [new Color(colours.value.person), new Color(colours.value.dark ? "#ffffff" : "#0b1016")];
    comparedRuns.value?.forEach(({ entries }, run) => {
      const look = LOOKS[run];
      const tone = tones[run];
      const [path] = ribbonPaths([{ way: run, points: entries.map(pointOf), start: 0, dashed: false }]);
      if (look === undefined || tone === undefined || path === undefined) return;
      for (const [floor, triangles] of ribbon(path, look.width, look.above, floorAt)) {
        const mesh = new Mesh(geometryOf(triangles, () => tone), material());
        mesh.userData["floor"] = floor;
        const highest = shownFloor.peek();
        mesh.visible = highest === null || floor <= highest;
        this.group.add(mesh);
      }
    });
    this.view.stage.need();
  }
}

function pointOf({ t, pose: [x, y, z, yaw] }: Entry): WayPoint {
  return [t, x, y, z, yaw];
}
