/** The robot of the shown run, or at the mission's start, and the ghost of the navigation tool. */

import { computed, effect, signal } from "@preact/signals-core";
import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, Vector3 } from "three";

import { fetchFile, delay, Unreached } from "../api/client";
import type { World } from "../api/types";
import type { ShownMode } from "../model/run-mode";
import { floorOf } from "../model/standing-map";
import { mission, planId } from "../state/plan";
import { run, shownEntries, shownRun, shownRunState } from "../state/run";
import { following, shownFloor } from "../state/view";
import { world } from "../state/world";
import { type Colours, colours } from "./colours";
import { readGlb } from "./glb";
import { dependOn } from "../state/depend-on";
import { poseOf } from "./marks";
import { ghost } from "./navigate";
import { Ghost, RobotBody } from "./robot";
import type { SceneView } from "./view";

type Vector5 = readonly [number, number, number, number, number];
const RETRY_MS = 1_500;
/** s, time constant with which the drawn robot approaches the reported pose */
const SMOOTH = 0.09;
/** m: over longer distances the robot is moved at once */
const JUMP = 1.5;
const STILL = 0.002;
/** Modes in which the run is over. */
const OVER: ReadonlySet<ShownMode> = new Set(["good", "notice", "bad"]);
const TRAIL_Z = 0.06;
/** m, height of its top above the ground */
const TOP = 1.1;

// These values rarely change with a new pose.
const trailPlan = computed(() => shownRun.value?.plan);
const trailLength = computed(() => shownRun.value?.entries ?? 0);

export class RobotView {
  private body: RobotBody | null = null;
  private ghost: Ghost | null = null;
  private target: Vector5 | null = null;
  private now: Vector5 | null = null;
  private mode: ShownMode | null = null;
  /** The values of the last update. */
  private aimed: readonly unknown[] = [];
  private drawnTrail: readonly unknown[] = [];
  private readonly trail = new Line(new BufferGeometry(), new LineBasicMaterial());
  private readonly stops: (() => void)[] = [];
  /** Position of the drawn robot and mode of its run; null: there is none. */
  readonly shown = signal<{ readonly at: Vector3; readonly floor: number; readonly mode: ShownMode } | null>(null);
  private over = false;
  private loaded = "";

  constructor(private readonly view: SceneView) {
    const { stage } = view;
    this.trail.frustumCulled = false;
    stage.scene.add(this.trail);
    stage.moving.add(this.move);
    this.stops.push(
      effect(() => {
        const site = world.value;
        if (site !== null) void this.load(site);
      }),
      effect(() => this.aim()),
      effect(() => this.showGhost()),
      effect(() => this.showTrail()),
    );
  }

  dispose(): void {
    this.over = true;
    for (const stop of this.stops) stop();
    this.view.stage.moving.delete(this.move);
    this.body?.dispose();
    this.ghost?.dispose();
    this.trail.geometry.dispose();
    this.trail.material.dispose();
    this.trail.removeFromParent();
  }

  private async load(site: World): Promise<void> {
    if (this.loaded === site.name) return;
    this.loaded = site.name;
    for (let done = false; !done; )
      try {
        const nodes = readGlb(await fetchFile("/api/world/robot"));
        if (this.over || this.loaded !== site.name) return;
        this.body?.dispose();
        this.ghost?.dispose();
        this.body = new RobotBody(nodes, site);
        this.ghost = new Ghost(nodes, site);
        this.view.stage.scene.add(this.body.group, this.ghost.group);
        done = true;
      } catch (error) {
        if (!(error instanceof Unreached)) throw error;
        await delay(RETRY_MS);
        if (this.over) return;
      }
    this.now = null;
    this.aim();
    this.showGhost();
  }

  /** Set the pose at which the robot is to be drawn, and its mode. */
  private aim(): void {
    const now = shownRun.value;
    const state = shownRunState.value;
    const site = world.value;
    if (site === null) return;
    // A finished run of another mission is not shown here.
    const tells = now !== null && state !== null && (now.plan === planId.value || (run.value === state && state.status !== "ended"));
    this.target = tells ? now.pose : startOf(site);
    this.mode = tells ? now.mode : null;
    this.body?.mark(this.mode && ringColour(this.mode, colours.value));
    // Poses arrive several times a second, also if the robot stands: then it is not drawn again.
    const pose = this.target ?? [];
    const aimed = [this.body, this.mode, now === null, ...dependOn(colours, shownFloor, following), ...pose];
    if (same(aimed, this.aimed)) return;
    this.aimed = aimed;
    this.view.stage.need();
  }

  private readonly move = (dt: number): boolean => {
    const [to, from] = [this.target, this.now];
    if (to === null || this.body === null) return false;
    const away = from === null ? Infinity : Math.hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
    const share = away > JUMP ? 1 : 1 - Math.exp(-dt / SMOOTH);
    const turn = from === null ? 0 : Math.atan2(Math.sin(to[3] - from[3]), Math.cos(to[3] - from[3]));
    const there = share === 1 || from === null || (away < STILL && Math.abs(turn) < STILL);
    const along = (i: 0 | 1 | 2 | 4) => (there ? to[i] : from[i] + (to[i] - from[i]) * share);
    const moved = from === null || !there || to.some((value, i) => value !== from[i]);
    const now: Vector5 = [along(0), along(1), along(2), there ? to[3] : from[3] + turn * share, along(4)];
    this.now = now;
    this.body.put(now);
    const floor = floorOf(world.peek()?.floors ?? [], now[2])?.number ?? 1;
    const how = following.peek();
    if (how !== "off" && shownRun.peek() !== null) {
      if (shownFloor.peek() !== floor) shownFloor.value = floor;
      if (moved) this.view.camera.follow(new Vector3(now[0], now[1], now[2]), now[3], how);
    }
    this.body.group.visible = this.view.site.isShown(floor);
    this.shown.value = this.mode && !OVER.has(this.mode) ? { at: new Vector3(now[0], now[1], now[2] + TOP), floor, mode: this.mode } : null;
    return !there;
  };

  private showGhost(): void {
    const at = ghost.value;
    const now = colours.value;
    if (this.ghost === null) return;
    if (at === null) this.ghost.group.visible = false;
    else this.ghost.put(at.x, at.y, at.z, at.yaw, ghostColour(at.verdict?.ground, now));
    this.view.stage.need();
  }

  /** Draw the path that was driven so far, on the shown floors. */
  private showTrail(): void {
    const highest = shownFloor.value;
    const site = world.value;
    const shown = trailPlan.value !== planId.value ? [] : shownEntries.value.slice(0, trailLength.value);
    const points: number[] = [];
    for (const { pose } of shown) {
      const floor = floorOf(site?.floors ?? [], pose[2])?.number ?? 1;
      const point = [pose[0], pose[1], pose[2] + TRAIL_Z];
      const stays = point.every((value, i) => value === points.at(i - 3));
      if (!stays && (highest === null || floor <= highest)) points.push(...point);
    }
    // A standing robot sends entries as well.
    const drawn = [colours.value, ...points];
    if (same(drawn, this.drawnTrail)) return;
    this.drawnTrail = drawn;
    this.trail.geometry.dispose();
    this.trail.geometry = new BufferGeometry();
    this.trail.geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
    this.trail.visible = points.length > 3;
    this.trail.material.color.set(colours.value.text);
    this.view.stage.need();
  }
}

function same(one: readonly unknown[], other: readonly unknown[]): boolean {
  return one.length === other.length && one.every((value, i) => value === other[i]);
}

/** Return the pose of the robot before it is started. */
function startOf(site: World): Vector5 | null {
  const start = mission.value?.tasks.find((task) => task.action === "START");
  const pose = start ? poseOf(start, site) : site.docks[0]?.pose;
  return pose ? [pose.x, pose.y, pose.z, pose.yaw, 0] : null;
}

/** Return the ring's colour, which is that of the run's band. */
function ringColour(mode: ShownMode, now: Colours): string {
  switch (mode) {
    case "autonomous":
      return now.accent;
    case "supervised":
      return now.person;
    case "paused":
    case "stopping":
    case "notice":
      return now.warn;
    case "reacting":
    case "interrupted":
    case "bad":
      return now.bad;
    case "good":
      return now.good;
    case "preparing":
    case "unknown":
      return now.dim;
  }
}

function ghostColour(ground: string | undefined, now: Colours): string {
  if (ground === undefined) return now.dim;
  return ground === "reached" ? (now.dark ? "#4ade80" : "#18a34a") : "#e5352b";
}
