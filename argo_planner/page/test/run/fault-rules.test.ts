import { expect, test } from "vitest";

import type { FaultDescription, FaultField, World } from "../../src/api/types";
import {
  atCheckpoint,
  checkpointOf,
  faultProblems,
  faultsByCase,
  markPoint,
  placedAt,
  placeForm,
  refusalOf,
  withField,
  type FaultDraft,
} from "../../src/model/faults";

const SITE = {
  ground: [-1, -1, 9, 9],
  ground_z: -0.03,
  floors: [
    { number: 1, z: 0, storey: 3, plates: [[0, 0, 8, 8]] },
    { number: 2, z: 3, storey: 3, plates: [[0, 0, 4, 4], [6, 6, 8, 8]] },
  ],
  checkpoints: [
    { id: 4, position: [1, 2, 1.5], floor: 1, stands: { x: 1, y: 1, z: 0, yaw: 0 }, unit: "bar", range: { low: 0, high: 10 }, nominal: { low: 2, high: 4 } },
  ],
} as unknown as World;

const field = (name: string, ...numbers: object[]) => ({ name, numbers }) as unknown as FaultField;
const kind = (name: string, ...fields: FaultField[]) => ({ kind: name, timed: true, needs_world: true, fields }) as unknown as FaultDescription;
const AT = field("at", { least: 0 });
const LEAK = kind("gas_leak", AT, field("until", { above: 0 }), field("place", { least: -5, most: 9 }, { least: -5, most: 9 }, { least: -1, most: 9 }), field("rate", { above: 0, most: 1 }));
const BRICK = kind("brick", field("floor"), field("place", {}, {}), field("size", { above: 0, most: 1.5 }, { above: 0, most: 1.5 }, { above: 0, most: 1.5 }));
const PLATE = kind("missing_plate", field("floor"), field("rect", {}, {}, {}, {}));
const LOSS = kind("connection_loss", field("floor"), field("rect", {}, {}, {}, {}));
const VALUE = kind("abnormal_value", field("checkpoint"), field("value", {}));
const ALARM = kind("platform_alarm", field("level", { least: 40, most: 120 }));

const problems = (fault: FaultDraft, description: FaultDescription) =>
  Object.fromEntries([...faultProblems(fault, description, SITE)].map(([name, problem]) => [name, problem.kind]));

test("limits are those of the service, open ends included", () => {
  const rate = (value: number) => problems({ kind: "gas_leak", rate: value }, LEAK);
  expect([0, 1e-9, 1, 1.1].map((value) => rate(value)["rate"])).toEqual(["limits", undefined, undefined, "limits"]);
  expect(problems({ kind: "brick", floor: 1, place: [1, 1], size: [0.1, 2, 0.1] }, BRICK)).toEqual({ size: "limits" });
  expect(problems({ kind: "gas_leak", place: [1, 20, 1] }, LEAK)).toEqual({ place: "limits" });
});

test("a fault ends after it begins, and may never end", () => {
  expect(problems({ kind: "gas_leak", at: 10, until: 10 }, LEAK)).toEqual({ until: "ends early" });
  expect(problems({ kind: "gas_leak", at: 10, until: 11 }, LEAK)).toEqual({});
  expect(problems({ kind: "gas_leak", at: 10 }, LEAK)).toEqual({});
});

test("what lies on the ground needs a floor, and a deck there", () => {
  expect(problems({ kind: "brick", place: [1, 1] }, BRICK)).toEqual({ place: "no floor" });
  expect(problems({ kind: "brick", floor: 2, place: [5, 5] }, BRICK)).toEqual({ place: "no deck" });
  expect(problems({ kind: "brick", floor: 2, place: [7, 7] }, BRICK)).toEqual({});
  expect(problems({ kind: "missing_plate", rect: [0, 0, 1, 1] }, PLATE)).toEqual({ rect: "no floor" });
  expect(problems({ kind: "missing_plate", floor: 2, rect: [4.5, 0, 5, 1] }, PLATE)).toEqual({ rect: "no deck" });
  expect(problems({ kind: "missing_plate", floor: 2, rect: [3.5, 0, 5, 1] }, PLATE)).toEqual({});
});

test("an area without a floor lies on the site, and has its corners in order", () => {
  expect(problems({ kind: "connection_loss", rect: [20, 20, 22, 22] }, LOSS)).toEqual({ rect: "off site" });
  expect(problems({ kind: "connection_loss", rect: [5, 5, 5, 8] }, LOSS)).toEqual({ rect: "wrong corners" });
  expect(problems({ kind: "connection_loss", rect: [5, 5, 6, 8] }, LOSS)).toEqual({});
});

test("an abnormal value is on the scale of its checkpoint, and not normal", () => {
  const value = (number: number) => problems({ kind: "abnormal_value", checkpoint: 4, value: number }, VALUE)["value"];
  expect([11, 3, 5].map(value)).toEqual(["off scale", "normal", undefined]);
  expect(problems({ kind: "abnormal_value", value: 99 }, VALUE)).toEqual({});
});

test("a click gives each kind its place", () => {
  const click = (description: FaultDescription, checkpoint: number | null = null, corner: readonly [number, number, number] | null = null) =>
    placedAt({ kind: description.kind }, description, { point: [3.004, 2, 3], checkpoint }, corner, SITE);
  expect(click(LEAK)).toEqual({ kind: "gas_leak", place: [3, 2, 3] });
  expect(click(LEAK, 4)).toEqual({ kind: "gas_leak", place: [1, 2, 1.5] });
  expect(click(BRICK)).toEqual({ kind: "brick", place: [3, 2], floor: 2 });
  expect(click(PLATE, null, [3.5, 1, 3])).toEqual({ kind: "missing_plate", rect: [3, 1, 3.5, 2], floor: 2 });
  expect(click(VALUE)).toBeNull();
  expect(click(VALUE, 4)).toEqual({ kind: "abnormal_value", checkpoint: 4 });
  expect([placeForm(ALARM), click(ALARM)]).toEqual([null, null]);
});

test("a fault at a checkpoint is found there again, and moved away it is not", () => {
  for (const description of [LEAK, BRICK, PLATE, VALUE]) {
    const placed = atCheckpoint({ kind: description.kind }, description, 4, SITE);
    expect(checkpointOf(placed, description, SITE)).toBe(4);
    expect(problems(placed, description)).toEqual({});
    expect(markPoint(placed, SITE)).not.toBeNull();
  }
  const leak = withField(atCheckpoint({ kind: "gas_leak" }, LEAK, 4, SITE), "place", [1, 2, 1.4]);
  expect(checkpointOf(leak, LEAK, SITE)).toBeNull();
  expect(checkpointOf({ kind: "gas_leak" }, LEAK, SITE)).toBeNull();
});

test("marks stand in the middle of an area, on its floor; a drawn place has none", () => {
  expect(markPoint({ kind: "missing_plate", floor: 2, rect: [0, 0, 2, 4] }, SITE)).toEqual([1, 2, 3]);
  expect(markPoint({ kind: "brick", floor: 1, place: [1, 2] }, SITE)).toEqual([1, 2, 0]);
  expect(markPoint({ kind: "gas_leak", rate: 0.1 }, SITE)).toBeNull();
});

test("a field that is emptied is left out", () => {
  expect(withField({ kind: "gas_leak", rate: 1 }, "rate", undefined)).toEqual({ kind: "gas_leak" });
});

test("the service's refusal belongs to the fault that it names", () => {
  const refusal = "faults[0] (brick): no walkway; faults[2] (gas_leak): no equipment";
  expect([0, 1, 2].map((at) => refusalOf(refusal, at))).toEqual(["no walkway", null, "no equipment"]);
  expect(refusalOf(null, 0)).toBeNull();
});

test("cases of an evaluation are named as the service names them", () => {
  const faults = [{ kind: "brick", n: 1 }, { kind: "gas_leak", n: 2 }, { kind: "brick", n: 3 }];
  expect([...faultsByCase(faults)].map(([name, { n }]) => [name, n])).toEqual([["brick 1", 1], ["gas_leak", 2], ["brick 2", 3]]);
});
