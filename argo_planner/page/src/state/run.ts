/** The run that the robot is in or was in last, as the service tells it; or one that was, gone back over. */

import { batch, computed, effect, signal } from "@preact/signals-core";

import { answered, authorQuery, client, Unreached } from "../api/client";
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
import { tell, tellError } from "./notices";
import { planId } from "./plan";
import { isMe } from "./session";

export interface RobotPose {
  readonly t: number;
  /** x, y, z (m), yaw, pitch (rad) */
  readonly pose: readonly [number, number, number, number, number];
  readonly charge: number | null;
}

export const run = signal<RunState | null>(null);
export const robotPose = signal<RobotPose | null>(null);
/** What has happened in the run, in order. */
export const entries = signal<readonly Entry[]>([]);
/** Whether a run is under way, or waits to go on. */
export const runIsOn = computed(() => run.value !== null && run.value.status !== "ended");
export const robotConnected = signal(false);

export interface PastRun {
  readonly state: RunState;
  readonly entries: readonly Entry[];
  /** The run of an evaluation it is, made once more. */
  readonly evaluated?: FailedRun;
}
/** A run that was, which is shown in place of the one of the robot; null: that one is. */
export const pastRun = signal<PastRun | null>(null);
/** s of the run that is shown, to which the page goes back; null: its newest moment. */
export const shownTime = signal<number | null>(null);
effect(() => {
  const plan = planId.value;
  const past = pastRun.peek();
  if (past !== null && past.state.plan !== plan) pastRun.value = shownTime.value = null;
});
/** The run that is shown: a past one, or the robot's. */
export const shownRunState = computed(() => pastRun.value?.state ?? run.value);
export const shownEntries = computed(() => pastRun.value?.entries ?? entries.value);

/** What the run that is shown is or was like at the time that is shown: where the robot is, what is
 * done and read. For the scene and the list, in place of the live values. */
export interface ShownRun extends Moment {
  /** id of the mission */
  readonly plan: string;
  /** Whether it is the robot as it is now. */
  readonly live: boolean;
}
/** Made anew with entries only, and not with each pose. */
const shownMoment = computed(() => momentAt(shownEntries.value, shownTime.value ?? Infinity));
export const shownRun = computed<ShownRun | null>(() => {
  const state = shownRunState.value;
  if (state === null) return null;
  const { plan } = state;
  const back = shownTime.value;
  const past = pastRun.value !== null;
  const moment = shownMoment.value;
  if (past || back !== null)
    return moment && { ...moment, plan, live: false };
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
    entries: entries.value.length,
    plan,
    live: true,
  };
});

/** Entries come one by one, and many at once when the page opens; they are shown together. */
const ENTRIES_MS = 40;
/** Ids of requests of which no notice says that nothing comes of them. */
export const quiet = new Set<string>();
let live: LiveConnection<RunMessage> | null = null;
let shownLast = 0;
let comeIn: Entry[] = [];
let showing: ReturnType<typeof setTimeout> | undefined;
let catchingUp = false;

/** Follows whatever the robot does, from now on. */
export function followRobot(): void {
  live ??= new LiveConnection<RunMessage>({
    address: () => `/api/robot/live?${[since(), authorQuery()].filter(Boolean).join("&")}`,
    heard,
    changed: (there) => (robotConnected.value = there),
  });
}

function since(): string {
  const known = entries.value.length + comeIn.length;
  return known > 0 ? `since=${known}` : "";
}

/** Shows a run that was; null: the robot's. Throws `Refusal` or `Unreached`. */
export async function showRun(id: string | null): Promise<void> {
  if (id === null || id === run.value?.id) {
    shownLast++;
    batch(() => {
      pastRun.value = null;
      shownTime.value = null;
    });
    return;
  }
  const turn = ++shownLast;
  const state = await answered(client.GET("/api/runs/{run}", { params: { path: { run: id } } }));
  const found = await entriesOf(id, 0);
  if (turn !== shownLast || planId.value !== state.plan) return;
  batch(() => {
    pastRun.value = { state, entries: found };
    shownTime.value = null;
  });
}

/** Shows a run of an evaluation as it went, unless another mission is open by now. */
export function showReplay({ state, entries }: ReplayedRun, evaluated: FailedRun): void {
  if (planId.value !== state.plan) return;
  shownLast++;
  batch(() => {
    pastRun.value = { state, entries, evaluated };
    shownTime.value = null;
  });
}

/** The entries of a run after the first `since`. Throws `Refusal` or `Unreached`. */
async function entriesOf(id: string, since: number): Promise<Entry[]> {
  const found: Entry[] = [];
  for (;;) {
    const query = { since: since + found.length };
    const part = await answered(
      client.GET("/api/runs/{run}/entries", { params: { path: { run: id }, query } }),
    );
    found.push(...part.entries);
    if (part.entries.length === 0 || query.since + part.entries.length >= part.count) return found;
  }
}

/** Takes how the run of the robot stands. */
export function takeState(state: RunState | null): void {
  batch(() => {
    if (state?.id !== run.value?.id) {
      entries.value = [];
      comeIn = [];
      robotPose.value = null;
      shownTime.value = null;
      // Whoever has begun another run wants to see it.
      if (state?.status !== "ended") pastRun.value = null;
    }
    run.value = state;
  });
}

function heard(message: RunMessage): void {
  switch (message.kind) {
    case "state":
      takeState(message.state);
      // Those of a run that began and ended while nothing was heard are not told one by one.
      if (message.state?.status === "ended" && message.state.entries > entries.value.length + comeIn.length)
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

/** Requests come before the state that has them, so that whoever has asked hears at once. */
function takeRequest(id: string, request: RequestState): void {
  const now = run.value;
  if (now?.id === id) {
    const others = now.requests.filter((one) => one.id !== request.id);
    run.value = { ...now, requests: [...others, request] };
  }
  if (request.reason && request.progress !== "confirmed" && isMe(request.by) && !quiet.has(request.id))
    tell("warn", request.reason);
}

function takeEntry(id: string, number: number, entry: Entry): void {
  if (id !== run.value?.id) return;
  const next = entries.value.length + comeIn.length + 1;
  if (number > next) void catchUp(id);
  if (number !== next || catchingUp) return;
  comeIn.push(entry);
  showing ??= setTimeout(showComeIn, ENTRIES_MS);
}

function showComeIn(): void {
  showing = undefined;
  if (comeIn.length > 0) entries.value = [...entries.value, ...comeIn];
  comeIn = [];
}

/** Reads the entries that were not told here, as another run was known when it began. */
async function catchUp(id: string): Promise<void> {
  if (catchingUp) return;
  catchingUp = true;
  try {
    showComeIn();
    const missed = await entriesOf(id, entries.value.length);
    if (run.value?.id === id) entries.value = [...entries.value, ...missed];
  } catch (error) {
    if (!(error instanceof Unreached)) tellError(error);
  } finally {
    catchingUp = false;
  }
}
