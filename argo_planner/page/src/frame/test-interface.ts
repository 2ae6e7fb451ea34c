/** Functions for end-to-end tests of the scene, which has no DOM elements to look for. */

import type { Ground } from "../model/standing-map";

export interface ArgoTestInterface {
  /** Position of a point of the site (m) on the page (px), and whether it is inside the view on a shown floor. */
  project(x: number, y: number, z: number): { readonly x: number; readonly y: number; readonly visible: boolean };
  /** Whether the site is loaded and completely drawn. */
  idle(): boolean;
  /** Whether the robot can stand at a pose (m, rad); null: the maps are not loaded. */
  standing(x: number, y: number, z: number, yaw: number): Ground | null;
  camera(): {
    readonly position: readonly [number, number, number];
    readonly target: readonly [number, number, number];
  };
  /** Draw calls and triangles of the last frame, and the durations (ms) of verdicts under the pointer. */
  figures(): { readonly calls: number; readonly triangles: number; readonly hover: readonly number[] };
}

declare global {
  interface Window {
    argo?: ArgoTestInterface;
  }
}

export function publishTestInterface(made: ArgoTestInterface): void {
  window.argo = made;
}

export function removeTestInterface(made: ArgoTestInterface): void {
  if (window.argo === made) delete window.argo;
}
