/** The camera: moved by mouse, by keys, and to requested views. */

import CameraControls from "camera-controls";
import {
  Box3,
  Matrix4,
  Quaternion,
  Raycaster,
  Sphere,
  Spherical,
  Vector2,
  Vector3,
  Vector4,
  MathUtils,
} from "three";

import type { World, WorldCheckpoint, WorldFloor } from "../api/types";
import { following } from "../state/view";
import type { Stage } from "./stage";

CameraControls.install({
  THREE: { Box3, Matrix4, Quaternion, Raycaster, Sphere, Spherical, Vector2, Vector3, Vector4, MathUtils },
});

const { ACTION } = CameraControls;
/** rad: the initial view, from the south-west and above */
const [AZIMUTH, POLAR] = [-0.6, 0.95];
/** Distance that the camera moves in a second, relative to its distance from the target. */
const PACE = 0.35;
/** Radius of the view relative to the site's diagonal: less than half, as the site is not seen from its corners. */
const TIGHT = 0.48;
/** rad and m: viewpoints of a checkpoint; the first one with a free line of sight is used */
const TURNS = [0.35, -0.35, 0.8, -0.8, 0, 1.2, -1.2];
const HEIGHTS = [0.5, 0.75, 0.25, 1.05];
const NEAR = [2.6, 3.6, 1.8];
const FOLLOW = { behind: { away: 5.5, polar: 0.85 }, above: { away: 8, polar: 0.02 } };

export type Free = (from: Vector3, to: Vector3) => boolean;

export class SiteCamera {
  readonly controls: CameraControls;
  private readonly keys = new Set<string>();
  private fast = false;
  /** px per frame, by the pointer at an edge */
  private push = { x: 0, y: 0 };
  private site: World | null = null;
  /** Whether the camera is still in its initial position. */
  private untouched = true;

  constructor(private readonly stage: Stage) {
    const controls = new CameraControls(stage.camera, stage.canvas);
    this.controls = controls;
    controls.maxPolarAngle = 1.54;
    controls.minDistance = 0.6;
    controls.maxDistance = 150;
    controls.dollyToCursor = true;
    controls.smoothTime = 0.18;
    controls.draggingSmoothTime = 0.04;
    controls.restThreshold = 0.002;
    controls.mouseButtons.right = ACTION.TRUCK;
    controls.mouseButtons.middle = ACTION.TRUCK;
    controls.touches.two = ACTION.TOUCH_DOLLY_TRUCK;
    for (const what of ["controlstart", "control", "transitionstart", "update", "wake"] as const)
      controls.addEventListener(what, stage.need);
    for (const what of ["controlstart", "control", "transitionstart"] as const)
      controls.addEventListener(what, () => (this.untouched = false));
    controls.addEventListener("control", this.moved);
    stage.moving.add(this.move);
    stage.canvas.addEventListener("wheel", stage.need, { passive: true });
  }

  /** Stop following the robot when the person turns or moves the camera; zooming doesn't count. */
  private readonly moved = (): void => {
    const { currentAction } = this.controls;
    if (currentAction !== ACTION.NONE && currentAction !== ACTION.DOLLY) following.value = "off";
  };

  /** Whether the wheel zooms; otherwise it belongs to the tool. */
  set wheel(on: boolean) {
    this.controls.mouseButtons.wheel = on ? ACTION.DOLLY : ACTION.NONE;
  }

  setSite(site: World, glide: boolean): void {
    this.site = site;
    void this.showAll(null, glide);
    this.untouched = true;
  }

  /** Fit the whole site into a resized view, until somebody moves the camera. */
  resized(): void {
    if (!this.untouched || this.site === null) return;
    void this.controls.fitToSphere(this.around(null), false);
    this.untouched = true;
  }

  /** Show all floors up to a number. */
  async showAll(highest: number | null, glide = true): Promise<void> {
    this.controls.normalizeRotations();
    await Promise.all([
      this.controls.rotateTo(AZIMUTH, POLAR, glide),
      this.controls.fitToSphere(this.around(highest), glide),
      this.controls.setFocalOffset(0, 0, 0, false),
    ]);
  }

  private around(highest: number | null): Sphere {
    const site = this.site;
    if (site === null) return new Sphere(new Vector3(), 10);
    const top = site.floors.findLast((floor) => highest === null || floor.number <= highest);
    const [x0, y0, x1, y1] = site.ground;
    const z1 = (top?.z ?? 0) + 1.2;
    const z0 = highest === null ? site.ground_z : (top?.z ?? 0);
    return new Sphere(
      new Vector3((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2),
      TIGHT * Math.hypot(x1 - x0, y1 - y0, z1 - z0),
    );
  }

  /** Fit a floor, or all floors, into the view. The direction stays. */
  toFloor(floor: WorldFloor | null): void {
    void this.controls.setFocalOffset(0, 0, 0, true);
    void this.controls.fitToSphere(this.around(floor?.number ?? null), true);
    this.stage.need();
  }

  /** Look down from above, north up. */
  topView(): void {
    this.controls.normalizeRotations();
    void this.controls.rotateTo(0, 0.001, true);
    this.stage.need();
  }

  /** Look at a point from a distance (m), in the present direction. */
  lookAt(point: Vector3, away: number, glide = true): void {
    void this.controls.moveTo(point.x, point.y, point.z, glide);
    void this.controls.dollyTo(away, glide);
    this.stage.need();
  }

  /** Move to where the face of a checkpoint is visible. */
  lookAtFace(checkpoint: WorldCheckpoint, free: Free): void {
    const face = new Vector3(...checkpoint.position);
    const from = (turn: number, height: number, away: number) => {
      const yaw = checkpoint.facing + turn;
      const flat = away * Math.cos(height);
      return new Vector3(Math.cos(yaw) * flat, Math.sin(yaw) * flat, away * Math.sin(height)).add(face);
    };
    const options = NEAR.flatMap((away) =>
      HEIGHTS.flatMap((height) => TURNS.map((turn) => from(turn, height, away))),
    );
    const at = options.find((option) => free(option, face)) ?? from(0.35, 0.9, 3);
    this.controls.normalizeRotations();
    void this.controls.setLookAt(at.x, at.y, at.z, face.x, face.y, face.z, true);
    this.stage.need();
  }

  /** Follow the robot. */
  follow(at: Vector3, yaw: number, how: "behind" | "above"): void {
    const { away, polar } = FOLLOW[how];
    // Azimuth 0 is in the south; the camera is behind the robot, which looks along `yaw`.
    const wanted = how === "behind" ? yaw - Math.PI / 2 : 0;
    const { azimuthAngle } = this.controls;
    const turn = Math.atan2(Math.sin(wanted - azimuthAngle), Math.cos(wanted - azimuthAngle));
    void this.controls.moveTo(at.x, at.y, at.z + 0.4, true);
    void this.controls.rotateTo(azimuthAngle + turn, polar, true);
    void this.controls.dollyTo(away, true);
    this.stage.need();
  }

  /** Zoom in by steps; out if they are negative. */
  zoom(steps: number): void {
    void this.controls.dollyTo(this.controls.distance * 0.75 ** steps, true);
    this.stage.need();
  }

  turn(angle: number): void {
    void this.controls.rotate(angle, 0, true);
    this.stage.need();
  }

  /** Handle an arrow key that is pressed or released. */
  key(key: string, down: boolean, fast: boolean): void {
    if (down) following.value = "off";
    this.fast = fast;
    if (down) this.keys.add(key);
    else this.keys.delete(key);
    this.stage.need();
  }

  letGo(): void {
    this.keys.clear();
    this.push = { x: 0, y: 0 };
  }

  /** Move while the pointer is at an edge of the view: -1, 0 or 1 for each axis. */
  edge(x: number, y: number): void {
    this.push = { x, y };
    if (x !== 0 || y !== 0) this.stage.need();
  }

  dispose(): void {
    this.stage.moving.delete(this.move);
    this.stage.canvas.removeEventListener("wheel", this.stage.need);
    this.controls.dispose();
  }

  private readonly move = (dt: number): boolean => {
    const held = (key: string) => (this.keys.has(key) ? 1 : 0);
    const x = held("ArrowRight") - held("ArrowLeft") + this.push.x;
    const y = held("ArrowUp") - held("ArrowDown") - this.push.y;
    if (x !== 0 || y !== 0) {
      const step = PACE * (this.fast ? 2 : 1) * dt * Math.min(40, this.controls.distance);
      void this.controls.truck(x * step, 0, false);
      void this.controls.forward(y * step, false);
    }
    const moved = this.controls.update(dt);
    return moved || x !== 0 || y !== 0;
  };
}
