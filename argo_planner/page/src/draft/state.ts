/** The open draft of a script: what the service has answered, and the acts that are being sent. Acts are stored in
 * the browser until they are answered, so that a reload loses none. */

import { batch, computed, signal } from "@preact/signals-core";

import { client, delay, Refusal, responseData, Unreached } from "../api/client";
import type { DraftAct, DraftState } from "../api/types";
import { decidedByOthers, isDone, isLeft, type LineAct, stillApplies, toRequest, withActs } from "../model/draft-lines";
import { showError, showNotice } from "../state/notices";
import { storeSetting, storedSetting } from "../state/session";
import { t } from "../texts";

const RETRY_MS = 1_000;
/** ms between two looks whether somebody else has changed the draft */
const LOOK_MS = 3_000;
/** acts in one request */
const MOST_ACTS = 500;

/** The draft as the service has answered last; null: none is open. */
export const openedDraft = signal<DraftState | null>(null);
export const pendingActs = signal<readonly LineAct[]>([]);
/** Whether a request is under way. */
export const sendingActs = signal(false);
/** Acts of this session, the newest last; each has the labels of its lines. */
const history = signal<readonly (readonly string[])[]>([]);
/** Other words for lines that were not taken, by the labels of the lines, so that they can be sent again. */
export const returnedTexts = signal<ReadonlyMap<string, string>>(new Map());

export const shownLines = computed(() => withActs(openedDraft.value?.lines ?? [], pendingActs.value));
export const toConfirm = computed(() => shownLines.value.filter((line) => line.state === "proposed").length);
export const toAnswer = computed(() => shownLines.value.filter((line) => line.state === "open").length);
/** The open lines that can only be set aside, and mention nothing of a mission. */
export const namingNothing = computed(() => shownLines.value.filter((line) => line.names_nothing && line.state === "open" && !line.sending));
export const canUndo = computed(() => history.value.length > 0);
export const actsSaved = computed(() => pendingActs.value.length === 0 && !sendingActs.value);

/** Open a draft. Throws `Refusal` or `Unreached`. `isWanted`: whether it is still the one to open. */
export async function openDraft(id: string, isWanted: () => boolean): Promise<void> {
  const found = await responseData(client.GET("/api/drafts/{id}", { params: { path: { id } } }));
  if (!isWanted()) return;
  const { revision, acts } = storedActs(id);
  batch(() => {
    history.value = [];
    openedDraft.value = found;
    returnedTexts.value = new Map();
    pendingActs.value = acts.filter((act) => lineOf(found, act.label) !== undefined);
  });
  // Lines that are decided on differently since then have been decided on by somebody else.
  const changed = revision === found.revision ? [] : found.lines.filter((line) => line.act);
  dropConflicting(found, decidedByOthers(changed.map((line) => ({ ...line, act: null })), changed, acts));
  void send();
}

/** Look regularly whether somebody else has changed the open draft, and also once when the window gets the focus. */
export function followOthers(): () => void {
  const look = () => void lookForChanges();
  const timer = setInterval(look, LOOK_MS);
  addEventListener("focus", look);
  return () => {
    clearInterval(timer);
    removeEventListener("focus", look);
  };
}

let looking = false;
const hasOwnActs = () => !actsSaved.value;

async function lookForChanges(): Promise<void> {
  const id = openedDraft.value?.id;
  if (id === undefined || looking || hasOwnActs() || document.hidden) return;
  looking = true;
  try {
    const { drafts } = await responseData(client.GET("/api/drafts"));
    const draft = openedDraft.value;
    if (draft?.id !== id || hasOwnActs()) return; // the answer to an own act tells
    const now = drafts.find((one) => one.id === id);
    if (now === undefined) leaveGoneDraft(id);
    else if (now.revision > draft.revision) await readAgain(id);
  } catch (error) {
    if (!(error instanceof Unreached || error instanceof Refusal)) throw error; // it is looked again
  } finally {
    looking = false;
  }
}

/** Leave a draft that somebody else has made a mission, or deleted. */
function leaveGoneDraft(id: string): void {
  if (openedDraft.value?.id !== id) return;
  storeSetting(storageName(id), "");
  closeDraft();
  showNotice("warn", t().draft.gone);
  location.hash = "";
}

export function closeDraft(): void {
  batch(() => {
    openedDraft.value = null;
    pendingActs.value = [];
    history.value = [];
  });
}

/** Decide on lines: the page shows it at once, and sends it. */
export function decide(acts: readonly LineAct[]): void {
  if (acts.length === 0 || openedDraft.value === null) return;
  batch(() => {
    history.value = [...history.value, acts.map((act) => act.label)];
    add(acts);
  });
}

/** Undo the last decision of this session. Returns the label of its first line. */
export function undoLast(): string | null {
  const last = history.value.at(-1);
  if (last === undefined) return null;
  batch(() => {
    history.value = history.value.slice(0, -1);
    add(last.map((label) => ({ kind: "undo", label, sentences: [] })));
  });
  return last[0] ?? null;
}

function add(acts: readonly LineAct[]): void {
  pendingActs.value = [...pendingActs.value, ...acts];
  storeActs();
  void send();
}

/** Choose areas that the script leaves open. */
export async function chooseAreas(start: number | null, end: number | null): Promise<void> {
  await allSent();
  const draft = openedDraft.value;
  if (draft === null) return;
  await ask(draft, [{ kind: "areas", start_area: start, end_area: end }]).catch(showError);
}

/** Create the mission of a complete draft. Returns its id; null: a notice states why there is none. */
export async function completeDraft(): Promise<string | null> {
  await allSent();
  const draft = openedDraft.value;
  if (draft === null) return null;
  try {
    const made = await responseData(
      client.POST("/api/drafts/{id}/mission", {
        params: { path: { id: draft.id }, header: { "If-Match": `"${draft.revision}"` } },
      }),
    );
    return made.id;
  } catch (error) {
    if (isStale(error)) await readAgain(draft.id);
    else if (isGone(error)) leaveGoneDraft(draft.id);
    else showError(error);
    return null;
  }
}

async function allSent(): Promise<void> {
  while (openedDraft.value !== null && !actsSaved.value) await delay(20);
}

/** Send pending acts, until there are none. Acts that are made meanwhile go with the next request. */
async function send(): Promise<void> {
  if (sendingActs.value) return;
  sendingActs.value = true;
  try {
    for (;;) {
      const draft = openedDraft.value;
      const acts = pendingActs.value.slice(0, MOST_ACTS);
      if (draft === null || acts.length === 0) return;
      try {
        await ask(draft, toRequest(acts), acts);
      } catch (error) {
        if (error instanceof Unreached) {
          showNotice("warn", t().draft.notSent);
          await delay(RETRY_MS);
        } else if (isStale(error)) await readAgain(draft.id);
        else if (isGone(error)) leaveGoneDraft(draft.id);
        else {
          drop(draft.id, acts);
          showError(error);
        }
      }
    }
  } finally {
    sendingActs.value = false;
  }
}

async function ask(draft: DraftState, acts: DraftAct[], sent: readonly LineAct[] = []): Promise<void> {
  const answer = await responseData(
    client.POST("/api/drafts/{id}/acts", {
      params: { path: { id: draft.id }, header: { "If-Match": `"${draft.revision}"` } },
      body: { acts },
    }),
  );
  take(answer, sent);
}

/** Take a new state of the draft, in which acts have been carried out. Pending acts on lines that have become
 * something else are dropped, and a notice names the lines. */
function take(answer: DraftState, sent: readonly LineAct[]): void {
  const before = openedDraft.value;
  if (before?.id !== answer.id) return;
  const done = new Set(sent);
  const later = pendingActs.value.filter((act) => !done.has(act));
  const valid = later.filter((act) => stillApplies(act, lineOf(answer, act.label)));
  batch(() => {
    openedDraft.value = { ...answer, lines: keepEqual(before.lines, answer.lines) };
    pendingActs.value = valid;
  });
  storeActs();
  tell(answer, sent, later.filter((act) => !valid.includes(act)));
}

function tell(answer: DraftState, sent: readonly LineAct[], dropped: readonly LineAct[]): void {
  const opened = sent.filter((act) => {
    const line = lineOf(answer, act.label);
    return act.kind !== "undo" && act.kind !== "say" && line !== undefined && isLeft(line);
  });
  const labels = [...new Set([...opened, ...dropped].map((act) => act.label))];
  if (labels.length > 0) showNotice("warn", t().draft.becameOther(labels));
}

/** Return the new lines, with the old object for each line that is equal, so that it is not drawn again. */
function keepEqual(before: DraftState["lines"], after: DraftState["lines"]): DraftState["lines"] {
  return after.map((line, at) => {
    const old = before[at];
    return old !== undefined && JSON.stringify(old) === JSON.stringify(line) ? old : line;
  });
}

/** Read a draft that somebody else has changed. */
async function readAgain(id: string): Promise<void> {
  try {
    const found = await responseData(client.GET("/api/drafts/{id}", { params: { path: { id } } }));
    const before = openedDraft.value;
    if (before?.id !== id) return;
    const others = decidedByOthers(before.lines, found.lines, pendingActs.value);
    const lost = dropConflicting(found, others);
    take(found, []);
    const further = [...others].filter((label) => !lost.has(label));
    if (further.length > 0) showNotice("info", t().draft.decidedByOthers(further));
  } catch (error) {
    if (error instanceof Unreached) await delay(RETRY_MS);
    else if (isGone(error)) leaveGoneDraft(id);
    else {
      drop(id, pendingActs.value);
      showError(error);
    }
  }
}

/** Drop the pending acts that are carried out already, and those on lines that somebody else has decided on: their
 * decision counts, and a notice tells what this person had decided. Returns the labels of the latter. */
function dropConflicting(found: DraftState, others: ReadonlySet<string>): ReadonlySet<string> {
  const last = new Map(pendingActs.value.map((act) => [act.label, act]));
  const lost = [...last.values()].filter((act) => others.has(act.label));
  const done = [...last.values()].filter((act) => {
    const line = lineOf(found, act.label);
    return line !== undefined && isDone(act, line);
  });
  const dropped = new Set([...others, ...done.map((act) => act.label)]);
  batch(() => {
    pendingActs.value = pendingActs.value.filter((act) => !dropped.has(act.label));
    history.value = history.value
      .map((labels) => labels.filter((label) => !others.has(label)))
      .filter((labels) => labels.length > 0);
  });
  storeActs();
  returnTexts(lost);
  if (lost.length > 0)
    showNotice("warn", t().draft.notTaken, {
      details: lost.slice(0, 8).map((act) => t().draft.wasMeant(act.label, t().draft.kind[act.kind], act.sentences.join(" "))),
    });
  return new Set(lost.map((act) => act.label));
}

function drop(id: string, acts: readonly LineAct[]): void {
  if (openedDraft.value?.id !== id) return;
  pendingActs.value = pendingActs.value.filter((act) => !acts.includes(act));
  storeActs();
  returnTexts(acts);
}

function returnTexts(acts: readonly LineAct[]): void {
  const texts = acts.filter((act) => act.kind === "say").map((act) => [act.label, act.sentences.join(" ")] as const);
  if (texts.length > 0) returnedTexts.value = new Map(texts);
}

function lineOf(draft: DraftState, label: string) {
  return draft.lines.find((line) => line.label === label);
}

const isStale = (error: unknown) => error instanceof Refusal && error.problem.code === "stale-revision";
const isGone = (error: unknown) => error instanceof Refusal && error.problem.code === "not-found";

/** Pending acts in the browser, with the revision of the draft that the person saw. */
interface StoredActs {
  readonly revision: number;
  readonly acts: readonly LineAct[];
}

function storeActs(): void {
  const draft = openedDraft.value;
  if (draft === null) return;
  const stored: StoredActs = { revision: draft.revision, acts: pendingActs.value };
  storeSetting(storageName(draft.id), stored.acts.length > 0 ? JSON.stringify(stored) : "");
}

function storedActs(id: string): StoredActs {
  const none = { revision: 0, acts: [] };
  try {
    const known: unknown = JSON.parse(storedSetting(storageName(id)) || "null");
    if (typeof known !== "object" || known === null || !("revision" in known) || !("acts" in known)) return none;
    const { revision, acts } = known;
    return typeof revision === "number" && Array.isArray(acts) ? { revision, acts: acts.filter(isAct) } : none;
  } catch {
    return none;
  }
}

function isAct(one: unknown): one is LineAct {
  return typeof one === "object" && one !== null && "kind" in one && "label" in one && "sentences" in one;
}

function storageName(id: string): string {
  return `acts.${id}`;
}
