/** Models of the robot: the driving one and the ghost. */

import {
  Color,
  DoubleSide,
  Group,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  PlaneGeometry,
  RingGeometry,
  Shape,
  ShapeGeometry,
} from "three";

import type { World } from "../api/types";
import { merged, wholeModel } from "./geometry";
import type { GlbNode } from "./glb";
import { dispose } from "./stage";

/** m above the ground, so that flat marks stay visible */
const ABOVE = 0.03;

/** The robot with a ring whose colour shows who controls it. */
export class RobotBody {
  readonly group = new Group();
  private readonly body = new Group();
  private readonly ring: Mesh<RingGeometry, MeshBasicMaterial>;

  constructor(nodes: readonly GlbNode[], site: World) {
    const material = new MeshLambertMaterial({ vertexColors: true, flatShading: true, side: DoubleSide });
    const mesh = new Mesh(merged(wholeModel(nodes)), material);
    mesh.receiveShadow = true;
    this.body.add(mesh);
    const outer = Math.hypot(site.robot.length, site.robot.width) / 2 + 0.2;
    this.ring = new Mesh(
      new RingGeometry(outer - 0.1, outer, 40),
      new MeshBasicMaterial({ side: DoubleSide, transparent: true, opacity: 0.9, depthWrite: false }),
    );
    this.ring.position.z = 2 * ABOVE;
    this.body.add(this.ring);
    this.body.rotation.order = "ZYX";
    this.group.add(this.body);
  }

  put(pose: readonly [number, number, number, number, number]): void {
    const [x, y, z, yaw, pitch] = pose;
    this.body.position.set(x, y, z);
    this.body.rotation.set(0, pitch, yaw);
  }

  /** Set the colour of the ring; null: no ring. */
  mark(colour: string | null): void {
    this.ring.visible = colour !== null;
    if (colour !== null) this.ring.material.color.set(colour);
  }

  dispose(): void {
    dispose(this.group);
  }
}

/** The translucent robot at a possible pose. */
export class Ghost {
  readonly group = new Group();
  private readonly body: Mesh;
  private readonly shape = new MeshLambertMaterial({
    flatShading: true,
    side: DoubleSide,
    transparent: true,
    opacity: 0.62,
  });
  private readonly floor = new MeshBasicMaterial({
    side: DoubleSide,
    transparent: true,
    opacity: 0.5,
    depthWrite: false,
    depthTest: false, // visible through objects before it
  });

  constructor(nodes: readonly GlbNode[], site: World) {
    this.body = new Mesh(merged(wholeModel(nodes)), this.shape);
    const { length, width, front, rear } = site.robot;
    const area = new Mesh(new PlaneGeometry(length, width), this.floor);
    area.position.set((front - rear) / 2, 0, ABOVE);
    const arrow = new Mesh(arrowShape(0.35, 0.4), this.floor);
    arrow.position.set(front + 0.1, 0, ABOVE);
    area.renderOrder = arrow.renderOrder = 8;
    this.group.add(this.body, area, arrow);
    this.group.visible = false;
  }

  put(x: number, y: number, z: number, yaw: number, colour: string): void {
    this.group.visible = true;
    this.group.position.set(x, y, z);
    this.group.rotation.z = yaw;
    this.shape.color = new Color(colour);
    this.floor.color = new Color(colour);
  }

  dispose(): void {
    dispose(this.group);
  }
}

/** Create an arrowhead on the ground that points along x. */
export function arrowShape(length: number, width: number): ShapeGeometry {
  const shape = new Shape();
  shape.moveTo(0, -width / 2);
  shape.lineTo(length, 0);
  shape.lineTo(0, width / 2);
  shape.lineTo(length * 0.28, 0);
  shape.closePath();
  return new ShapeGeometry(shape);
}
