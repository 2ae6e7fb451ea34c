/** The ways of the mission, as they will be driven. */

import type { SceneView } from "./view";

export class PathsView {
  constructor(private readonly view: SceneView) {}

  dispose(): void {
    this.view.stage.need();
  }
}
