/** Marks on the ground: arrows at the poses of tasks and locations, docks, obstacles. */

import {
  BoxGeometry,
  Color,
  DoubleSide,
  Group,
  InstancedMesh,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  PlaneGeometry,
} from "three";

import type { Obstacle, World } from "../api/types";
import { floorOf } from "../model/standing-map";
import type { Colours } from "./colours";
import type { Mark } from "./marks";
import { arrowShape } from "./robot";
import { dispose, type Stage } from "./stage";

const ABOVE = 0.025;
const MOST = 10_000;

export class GroundMarks {
  private readonly group = new Group();
  private readonly obstacles = new Group();
  private arrows: InstancedMesh | null = null;
  private readonly material = new MeshBasicMaterial({ side: DoubleSide, transparent: true, opacity: 0.85 });

  constructor(private readonly stage: Stage) {
    this.group.add(this.obstacles);
    stage.scene.add(this.group);
  }

  /** Show an arrow for each task with a pose, and for each location. */
  showArrows(marks: readonly Mark[], isShown: (floor: number) => boolean, colours: Colours): void {
    const all = marks
      .filter(({ subject, floor }) => (subject.kind === "task" || subject.kind === "place") && isShown(floor))
      .slice(0, MOST);
    if (this.arrows === null || this.arrows.instanceMatrix.count < all.length) {
      if (this.arrows) this.drop(this.arrows);
      this.arrows = new InstancedMesh(arrowShape(0.42, 0.36), this.material, 2 * all.length + 16);
      this.arrows.frustumCulled = false;
      this.group.add(this.arrows);
    }
    const arrows = this.arrows;
    arrows.count = all.length;
    all.forEach((mark, i) => {
      if (mark.subject.kind !== "task" && mark.subject.kind !== "place") return;
      const { x, y, z, yaw } = mark.subject.pose;
      const place = new Matrix4().makeRotationZ(yaw).setPosition(x, y, z + ABOVE);
      arrows.setMatrixAt(i, place.multiply(new Matrix4().makeTranslation(-0.15, 0, 0)));
      arrows.setColorAt(i, new Color(toneColour(mark.tone, colours)));
    });
    arrows.instanceMatrix.needsUpdate = true;
    if (arrows.instanceColor) arrows.instanceColor.needsUpdate = true;
    this.stage.need();
  }

  showObstacles(site: World, isShown: (floor: number) => boolean, colours: Colours, chosen: string | null): void {
    for (const one of [...this.obstacles.children]) dispose(one);
    for (const obstacle of site.obstacles) {
      if (!isShown(floorOf(site.floors, obstacle.pose.z)?.number ?? 1)) continue;
      const colour = obstacle.id === chosen ? colours.accent : colours.bad;
      this.obstacles.add(box(obstacle.pose, obstacle.size, colour, 0.75));
    }
    this.stage.need();
  }

  dispose(): void {
    dispose(this.group);
    this.arrows?.dispose();
    this.material.dispose();
  }

  private drop(mesh: InstancedMesh): void {
    mesh.removeFromParent();
    mesh.geometry.dispose();
    mesh.dispose();
  }
}

/** Create a box at a pose. */
export function box(pose: Obstacle["pose"], size: readonly number[], colour: string, opacity: number): Mesh {
  const [length = 1, width = 1, height = 1] = size;
  const material = new MeshLambertMaterial({ color: colour, transparent: true, opacity });
  const mesh = new Mesh(new BoxGeometry(length, width, height), material);
  mesh.position.set(pose.x, pose.y, pose.z + height / 2);
  mesh.rotation.z = pose.yaw;
  const foot = new Mesh(new PlaneGeometry(length + 0.1, width + 0.1), new MeshBasicMaterial({ color: colour }));
  foot.position.z = ABOVE - height / 2;
  mesh.add(foot);
  return mesh;
}

export function toneColour(tone: Mark["tone"], colours: Colours): string {
  switch (tone) {
    case "chosen":
      return colours.accent;
    case "active":
      return colours.warn;
    case "good":
      return colours.good;
    case "bad":
      return colours.bad;
    case "planned":
      return colours.dark ? "#f2f6fa" : "#20456b";
    case "plain":
      return colours.dark ? "#8fa6bd" : "#5f7f9f";
    case "dim":
      return colours.dark ? "#74cf95" : "#2f7d4f";
  }
}
