/** What end-to-end tests ask of the scene, which has no elements that they could look for. */

import type { Ground } from "../model/standing";

export interface ArgoTestInterface {
  /** Where a point of the site (m) is in the page (px), and whether it is in the picture and on a
   * floor that is shown. */
  project(x: number, y: number, z: number): { readonly x: number; readonly y: number; readonly visible: boolean };
  /** Whether the site is there and all is drawn. */
  idle(): boolean;
  /** Whether the robot can stand at a pose (m, rad); null: the maps are not there. */
  standing(x: number, y: number, z: number, yaw: number): Ground | null;
  camera(): {
    readonly position: readonly [number, number, number];
    readonly target: readonly [number, number, number];
  };
  /** Draw calls and triangles of the last frame, and ms that a verdict under the pointer took. */
  figures(): { readonly calls: number; readonly triangles: number; readonly hover: readonly number[] };
}

declare global {
  interface Window {
    argo?: ArgoTestInterface;
  }
}

export function offer(made: ArgoTestInterface): void {
  window.argo = made;
}

export function withdraw(made: ArgoTestInterface): void {
  if (window.argo === made) delete window.argo;
}
