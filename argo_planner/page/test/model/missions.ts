/** Missions for the tests. */

import type { Group, Mission, Task } from "../../src/api/types";

export function task(name: string, more: Partial<Task> = {}): Task {
  return {
    name,
    action: "MEASURE",
    group: "",
    object_id: "1",
    retries: 0,
    on_failure: "continue",
    optional: false,
    priority: 1,
    transitions: [],
    ...more,
  };
}

export function group(name: string, start: string, end: string): Group {
  return {
    name,
    start,
    end,
    max_repeat_count: 1,
    max_repeat_duration: 0,
    count_interruptions: false,
    stop: "hard",
    every: 0,
    until: [],
  };
}

/** Create a mission with tasks of these names, and groups. */
export function mission(names: string, ...groups: Group[]): Mission {
  return {
    version: 4,
    designation: "",
    site: "umad",
    mode: "autonomous",
    order: "precise",
    anomaly_specification: "",
    real_time_reporting: "",
    after_mission_report: "",
    tasks: names.split(" ").filter(Boolean).map((name) => task(name)),
    groups,
    reactions: [],
    left_out: [],
    before: [],
  };
}
