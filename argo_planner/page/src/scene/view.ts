/** The parts of the scene: it loads the site, and draws what the page's signals say. */

import { batch, effect, signal } from "@preact/signals-core";
import { Ray, Vector2, Vector3 } from "three";

import { delay, Unreached } from "../api/client";
import type { World } from "../api/types";
import { publishTestInterface, removeTestInterface, type ArgoTestInterface } from "../frame/test-interface";
import { floorOf } from "../model/standing-map";
import { showError } from "../state/notices";
import { taskKey } from "../model/outline";
import { mission, planId, select, selection } from "../state/plan";
import { look, shownFloor } from "../state/view";
import { world } from "../state/world";
import { SiteCamera } from "./camera";
import { Gauges } from "./checkpoints";
import { colours } from "./colours";
import { Dots } from "./dots";
import { GroundMarks, toneColour } from "./ground-marks";
import { dependOn } from "../state/depend-on";
import { Labels } from "./labels";
import { type Mark, marks, openMark } from "./marks";
import type { Frame } from "./pointer";
import { labelsShown, hidden } from "./settings";
import { Site } from "./site";
import { Stage } from "./stage";
import { standingVerdict } from "./standing-maps";

/** px within which a click hits a mark */
const NEAR_PX = 13;
const RETRY_MS = 1_500;
/** ms between tests of which marks are hidden behind objects, while the camera moves */
const LOOK_MS = 250;

export type Loading = "loading" | "there" | "failed";

export class SceneView {
  readonly stage: Stage;
  readonly camera: SiteCamera;
  readonly site: Site;
  readonly loading = signal<Loading>("loading");
  /** Number of drawn frames, a signal for elements at points of the site. */
  readonly frames = signal(0);
  /** ms that the last verdicts under the pointer took */
  hoverTimes: readonly number[] = [];
  private readonly gauges: Gauges;
  private readonly dots: Dots;
  private readonly ground: GroundMarks;
  private readonly labels: Labels;
  private readonly stops: (() => void)[] = [];
  private shown: readonly Mark[] = [];
  private behind = new Set<string>();
  private looked = 0;
  private plan: string | null = null;
  private loaded = "";
  private over = false;

  constructor(canvas: HTMLCanvasElement, labels: HTMLElement) {
    this.stage = new Stage(canvas);
    this.camera = new SiteCamera(this.stage);
    this.site = new Site(this.stage);
    this.gauges = new Gauges(this.stage);
    this.dots = new Dots(this.stage);
    this.ground = new GroundMarks(this.stage);
    this.labels = new Labels(labels, this.stage);
    this.stage.drawn.add(this.drawn);
    this.stops.push(
      effect(() => this.stage.light(colours.value)),
      effect(() => {
        const site = world.value;
        if (site !== null) void this.load(site);
      }),
      effect(() => this.resetFor(planId.value)),
      effect(() => {
        this.site.show(shownFloor.value, hidden.value);
        if (this.loading.value === "there") this.gauges.show((floor) => this.site.isShown(floor));
      }),
      effect(() => this.showMarks()),
      effect(() => this.fulfil()),
    );
    publishTestInterface(this.testing);
  }

  resize(width: number, height: number): void {
    this.stage.resize(width, height);
    this.camera.resized();
  }

  /** Return the ray from the camera through a point of the view (px). */
  rayAt(x: number, y: number): Ray {
    const { width, height } = this.stage.size;
    const { camera } = this.stage;
    const at = new Vector2((x / width) * 2 - 1, 1 - (y / height) * 2);
    const far = new Vector3(at.x, at.y, 0.5).unproject(camera);
    return new Ray(camera.position.clone(), far.sub(camera.position).normalize());
  }

  /** Return the position of a point of the site (m) in the view (px); null: outside. */
  project({ x, y, z }: { readonly x: number; readonly y: number; readonly z: number }): { x: number; y: number } | null {
    const seen = this.stage.project(new Vector3(x, y, z));
    const { width, height } = this.stage.size;
    return seen === null || seen.x < 0 || seen.y < 0 || seen.x > width || seen.y > height ? null : seen;
  }

  /** Return the mark at a point (px): the nearest one, or else that of a label. */
  markAt(x: number, y: number): Mark | null {
    const key = this.labels.at(x, y);
    let best: Mark | null = null;
    let least = Infinity;
    for (const mark of this.shown) {
      const seen = this.stage.project(mark.at);
      if (seen === null) continue;
      const away = Math.hypot(seen.x - x, seen.y - y);
      if (away > NEAR_PX) continue;
      // Visible marks come before hidden ones, and near ones before far ones.
      const rank = away + (this.isBehind(mark) ? 6 : 0) + seen.depth / 100;
      if (rank < least) [least, best] = [rank, mark];
    }
    return best ?? this.shown.find((mark) => mark.key === key) ?? null;
  }

  markOf(key: string | null): Mark | null {
    return this.shown.find((mark) => mark.key === key) ?? null;
  }

  /** Return the keys of the tasks whose marks are in a frame, in the order of the list. */
  tasksIn({ left, top, right, bottom }: Frame): string[] {
    const found = new Set<string>();
    for (const mark of this.shown) {
      const seen = mark.tasks.length === 0 ? null : this.stage.project(mark.at);
      if (seen !== null && seen.x >= left && seen.x <= right && seen.y >= top && seen.y <= bottom)
        for (const key of mark.tasks) found.add(key);
    }
    return (mission.peek()?.tasks ?? []).map((task) => taskKey(task.name)).filter((key) => found.has(key));
  }

  /** Select the clicked mark. */
  choose(mark: Mark | null, add: boolean): void {
    batch(() => {
      if (mark === null) {
        openMark.value = null;
        if (!add && selection.value.length > 0) select([]);
        return;
      }
      openMark.value = mark.subject.kind === "task" ? null : mark.key;
      const had = selection.value;
      const all = mark.tasks.length > 0 && mark.tasks.every((key) => had.includes(key));
      if (!add) select(mark.tasks);
      else if (all) select(had.filter((key) => !mark.tasks.includes(key)));
      else select([...had.filter((key) => !mark.tasks.includes(key)), ...mark.tasks]);
    });
  }

  dispose(): void {
    this.over = true;
    removeTestInterface(this.testing);
    for (const stop of this.stops) stop();
    this.labels.dispose();
    for (const part of [this.gauges, this.dots, this.ground, this.site, this.camera, this.stage]) part.dispose();
  }

  /** Show the whole site again if another mission is opened. */
  private resetFor(plan: string | null): void {
    const site = world.peek();
    if (plan === null || plan === this.plan) return;
    if (this.plan !== null && site !== null) this.camera.setSite(site, false);
    this.plan = plan;
  }

  private async load(site: World): Promise<void> {
    // Obstacles change the digest, but no mesh.
    if (this.loaded === site.name) return;
    this.loaded = site.name;
    const cancelled = () => this.over || this.loaded !== site.name;
    while (!cancelled()) {
      try {
        await Promise.all([this.site.load(site, cancelled), this.gauges.load(site, cancelled)]);
        if (cancelled()) return;
        const [x0, y0, x1, y1] = site.ground;
        const top = site.floors.at(-1);
        this.stage.lightOver(
          new Vector3(x0, y0, site.ground_z),
          new Vector3(x1, y1, (top?.z ?? 0) + (top?.storey ?? 2.5)),
        );
        this.camera.setSite(site, false);
        this.loading.value = "there";
        return;
      } catch (error) {
        if (!(error instanceof Unreached)) throw error;
        this.loading.value = "failed";
        showError(error);
        await delay(RETRY_MS);
      }
    }
  }

  private showMarks(): void {
    const now = colours.value;
    const site = world.value;
    const highest = shownFloor.value;
    const isShown = (floor: number) => highest === null || floor <= highest;
    this.shown = marks.value.filter((mark) => isShown(mark.floor));
    this.dots.show(
      this.shown.map((mark) => ({
        key: mark.key,
        at: mark.at,
        colour: toneColour(mark.tone, now),
        rim: now.dark ? "#10151b" : "#ffffff",
        size: mark.weight >= 8 ? 17 : mark.weight >= 5 ? 14 : 11,
      })),
    );
    const tints = new Map<number, string>();
    for (const { subject, tone } of this.shown)
      if (subject.kind === "checkpoint" && (tone === "chosen" || tone === "active"))
        tints.set(subject.checkpoint.id, toneColour(tone, now));
    this.gauges.tint(tints);
    this.ground.showArrows(this.shown, isShown, now);
    const chosen = openMark.value?.startsWith("obstacle:") ? openMark.value.slice("obstacle:".length) : null;
    if (site !== null) this.ground.showObstacles(site, isShown, now, chosen);
    dependOn(labelsShown);
    this.looked = 0;
  }

  /** Move the camera to the requested view. */
  private fulfil(): void {
    const wish = look.value;
    const site = world.value;
    if (wish === null || site === null || this.loading.value !== "there") return;
    queueMicrotask(() => (look.value = null));
    if (wish.kind === "all") {
      void this.camera.showAll(shownFloor.peek());
    } else if (wish.kind === "pose") {
      const { x, y, z } = wish.pose;
      shownFloor.value = floorOf(site.floors, z)?.number ?? null;
      this.camera.lookAt(new Vector3(x, y, z + 0.3), 7);
    } else {
      const checkpoint = site.checkpoints.find((one) => String(one.id) === wish.id);
      if (!checkpoint) return;
      shownFloor.value = checkpoint.floor;
      queueMicrotask(() => this.camera.lookAtFace(checkpoint, (from, to) => !this.site.isBetween(from, to)));
    }
  }

  private readonly drawn = (): void => {
    const now = performance.now();
    if (this.stage.idle || now - this.looked > LOOK_MS) {
      this.looked = now;
      this.behind = new Set(this.shown.filter((mark) => this.isBehind(mark)).map((mark) => mark.key));
    }
    const named = labelsShown.peek() ? this.shown : this.shown.filter((mark) => mark.weight >= 6);
    this.labels.update(named, this.behind);
    this.frames.value++;
  };

  private isBehind(mark: Mark): boolean {
    return this.site.isBetween(this.stage.camera.position, mark.at, 0.25);
  }

  private readonly testing: ArgoTestInterface = {
    project: (x, y, z) => {
      const box = this.stage.canvas.getBoundingClientRect();
      const seen = this.stage.project(new Vector3(x, y, z));
      const floor = floorOf(world.value?.floors ?? [], z)?.number ?? 1;
      const inside = seen !== null && seen.x >= 0 && seen.y >= 0 && seen.x <= box.width && seen.y <= box.height;
      const place = { x: box.left + (seen?.x ?? 0), y: box.top + (seen?.y ?? 0) };
      return { ...place, visible: inside && this.site.isShown(floor) };
    },
    idle: () => this.loading.value === "there" && planId.value !== null && this.stage.idle,
    standing: (x, y, z, yaw) => standingVerdict(x, y, z, yaw)?.ground ?? null,
    camera: () => ({
      position: this.stage.camera.position.toArray(),
      target: this.camera.controls.getTarget(new Vector3()).toArray(),
    }),
    figures: () => ({ ...this.stage.figures, hover: this.hoverTimes }),
  };
}
