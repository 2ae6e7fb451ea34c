/** The box of the obstacle tool, before it stands there. */

import { effect } from "@preact/signals-core";
import type { Mesh } from "three";

import { colours } from "./colours";
import { box } from "./ground-marks";
import { spanned } from "./obstacle-tool";
import { dispose } from "./stage";
import type { SceneView } from "./view";

export class ObstacleView {
  private mesh: Mesh | null = null;
  private readonly stop: () => void;

  constructor(view: SceneView) {
    this.stop = effect(() => {
      const shown = spanned.value;
      if (this.mesh) dispose(this.mesh);
      this.mesh = shown && box(shown.pose, shown.size, colours.value.warn, 0.55);
      if (this.mesh) view.stage.scene.add(this.mesh);
      view.stage.need();
    });
  }

  dispose(): void {
    this.stop();
    if (this.mesh) dispose(this.mesh);
  }
}
