/** The present or last run of the robot, or a past run that is replayed. */

import { batch, computed, effect, signal } from "@preact/signals-core";

import { responseData, authorQuery, client, Unreached } from "../api/client";
import { LiveConnection } from "../api/live";
import type {
  Entry,
  FailedRun,
  ReplayedRun,
  RequestState,
  RunMessage,
  RunState,
} from "../api/types";
import { momentAt, type Moment } from "../model/replay";
import { shownMode, type ShownMode } from "../model/run-mode";
import { showNotice, showError } from "./notices";
import { planId } from "./plan";
import { isMe } from "./session";
import { said } from "../texts/messages";

export interface RobotPose {
  readonly t: number;
  /** x, y, z (m), yaw, pitch (rad) */
  readonly pose: readonly [number, number, number, number, number];
  readonly charge: number | null;
}

export const run = signal<RunState | null>(null);
export const robotPose = signal<RobotPose | null>(null);
/** The entries of the run, in order. */
export const entries = signal<readonly Entry[]>([]);
/** Whether a run is in progress or interrupted. */
export const runIsOn = computed(() => run.value !== null && run.value.status !== "ended");
/** When the connection to the robot's run was lost (ms since 1970); null: it is there, or was not there yet. */
export const robotLostAt = signal<number | null>(null);

export interface PastRun {
  readonly state: RunState;
  readonly entries: readonly Entry[];
  /** The run of an evaluation that was repeated. */
  readonly evaluated?: FailedRun;
}
/** A past run that is shown in place of the robot's; null: the robot's run is shown. */
export const pastRun = signal<PastRun | null>(null);
/** The time (s) of the shown run to which the page has gone back; null: its latest moment. */
export const shownTime = signal<number | null>(null);
effect(() => {
  const plan = planId.value;
  const past = pastRun.peek();
  if (past !== null && past.state.plan !== plan) pastRun.value = shownTime.value = null;
});
/** The state of the shown run: a past one, or the robot's. */
export const shownRunState = computed(() => pastRun.value?.state ?? run.value);
export const shownEntries = computed(() => pastRun.value?.entries ?? entries.value);

/** Return the present mode of a run; without a connection, that of the robot's run is unknown. */
export function presentMode(state: RunState): ShownMode {
  return shownMode(state, robotLostAt.value === null || state.id !== run.value?.id);
}

/** The shown run at the shown time: pose, outcomes and readings. The scene and the list use it in place of
 * live values. */
export interface ShownRun extends Omit<Moment, "control"> {
  readonly mode: ShownMode;
  /** id of the mission */
  readonly plan: string;
  /** Whether it is the robot's present state. */
  readonly live: boolean;
}
/** Computed again for new entries only, not for each pose. */
const shownMoment = computed(() => momentAt(shownEntries.value, shownTime.value ?? Infinity));
export const shownRun = computed<ShownRun | null>(() => {
  const state = shownRunState.value;
  if (state === null) return null;
  const { plan } = state;
  const back = shownTime.value;
  const past = pastRun.value !== null;
  const moment = shownMoment.value;
  if (past || back !== null)
    return moment && { ...moment, mode: moment.control === "ended" ? shownMode(state) : moment.control, plan, live: false };
  const now = robotPose.value;
  const pose = now?.pose ?? moment?.pose;
  if (pose === undefined) return null;
  return {
    t: Math.max(state.t, now?.t ?? 0),
    pose,
    charge: now?.charge ?? state.charge ?? null,
    task: state.task ?? null,
    outcomes: moment?.outcomes ?? new Map(),
    readings: state.readings,
    mode: presentMode(state),
    entries: entries.value.length,
    plan,
    live: true,
  };
});

/** Interval at which entries are shown together; many arrive at once when the page opens. */
const ENTRIES_MS = 40;
/** Ids of requests whose failure is not shown as a notice. */
export const quietRequests = new Set<string>();
let live: LiveConnection<RunMessage> | null = null;
let showTurn = 0;
let arrivedEntries: Entry[] = [];
let showing: ReturnType<typeof setTimeout> | undefined;
let catchingUp = false;

/** Follow the robot from now on. */
export function followRobot(): void {
  live ??= new LiveConnection<RunMessage>({
    address: () => `/api/robot/live?${[sinceQuery(), authorQuery()].filter(Boolean).join("&")}`,
    onMessage,
    onConnection: (there) => (robotLostAt.value = there ? null : (robotLostAt.value ?? Date.now())),
  });
}

function sinceQuery(): string {
  const known = entries.value.length + arrivedEntries.length;
  return known > 0 ? `since=${known}` : "";
}

/** Show a past run; null: the robot's. Throws `Refusal` or `Unreached`. */
export async function showRun(id: string | null): Promise<void> {
  if (id === null || id === run.value?.id) {
    showTurn++;
    batch(() => {
      pastRun.value = null;
      shownTime.value = null;
    });
    return;
  }
  const turn = ++showTurn;
  const state = await responseData(client.GET("/api/runs/{run}", { params: { path: { run: id } } }));
  const found = await entriesOf(id, 0);
  if (turn !== showTurn || planId.value !== state.plan) return;
  batch(() => {
    pastRun.value = { state, entries: found };
    shownTime.value = null;
  });
}

/** Show a repeated run of an evaluation, unless another mission is open by now. */
export function showReplay({ state, entries }: ReplayedRun, evaluated: FailedRun): void {
  if (planId.value !== state.plan) return;
  showTurn++;
  batch(() => {
    pastRun.value = { state, entries, evaluated };
    shownTime.value = null;
  });
}

/** Read the entries of a run after the first `since`. Throws `Refusal` or `Unreached`. */
export async function entriesOf(id: string, since: number): Promise<Entry[]> {
  const found: Entry[] = [];
  for (;;) {
    const query = { since: since + found.length };
    const part = await responseData(
      client.GET("/api/runs/{run}/entries", { params: { path: { run: id }, query } }),
    );
    found.push(...part.entries);
    if (part.entries.length === 0 || query.since + part.entries.length >= part.count) return found;
  }
}

/** Take the new state of the robot's run. */
export function takeState(state: RunState | null): void {
  batch(() => {
    if (state?.id !== run.value?.id) {
      entries.value = [];
      arrivedEntries = [];
      robotPose.value = null;
      shownTime.value = null;
      // A new run is shown in place of a past one.
      if (state?.status !== "ended") pastRun.value = null;
    }
    run.value = state;
  });
}

function onMessage(message: RunMessage): void {
  switch (message.kind) {
    case "state":
      takeState(message.state);
      // No messages bring the entries of a run that began and ended during a lost connection.
      if (message.state?.status === "ended" && message.state.entries > entries.value.length + arrivedEntries.length)
        void catchUp(message.state.id);
      break;
    case "pose":
      if (message.run === run.value?.id)
        robotPose.value = { t: message.t, pose: message.pose, charge: message.charge };
      break;
    case "entry":
      takeEntry(message.run, message.number, message.entry);
      break;
    case "request":
      takeRequest(message.run, message.request);
      break;
  }
}

/** Take the state of a request. It arrives before the run's state, so that the page can react at once. */
function takeRequest(id: string, request: RequestState): void {
  const now = run.value;
  if (now?.id === id) {
    const others = now.requests.filter((one) => one.id !== request.id);
    run.value = { ...now, requests: [...others, request] };
  }
  if (request.reason && request.progress !== "confirmed" && isMe(request.by) && !quietRequests.has(request.id))
    showNotice("warn", said(request.reason, request.reason_wording));
}

function takeEntry(id: string, number: number, entry: Entry): void {
  if (id !== run.value?.id) return;
  const next = entries.value.length + arrivedEntries.length + 1;
  if (number > next) void catchUp(id);
  if (number !== next || catchingUp) return;
  arrivedEntries.push(entry);
  showing ??= setTimeout(flushEntries, ENTRIES_MS);
}

function flushEntries(): void {
  showing = undefined;
  if (arrivedEntries.length > 0) entries.value = [...entries.value, ...arrivedEntries];
  arrivedEntries = [];
}

/** Read entries that arrived while another run was known here. */
async function catchUp(id: string): Promise<void> {
  if (catchingUp) return;
  catchingUp = true;
  try {
    flushEntries();
    const missed = await entriesOf(id, entries.value.length);
    if (run.value?.id === id) entries.value = [...entries.value, ...missed];
  } catch (error) {
    if (!(error instanceof Unreached)) showError(error);
  } finally {
    catchingUp = false;
  }
}
