/** Short names for the types of the service's OpenAPI document. */

import type { components, webhooks } from "./schema";

type Schemas = components["schemas"];

export type Mission = Schemas["Mission"];
export type Task = Schemas["Task"];
export type Group = Schemas["Group"];
export type Reaction = Schemas["Reaction"];
export type Condition = Schemas["Condition"];
export type Transition = Schemas["Transition"];
export type WaitRule = Schemas["WaitRule"];
export type TimeWindow = Schemas["TimeWindow"];
export type Pose = Schemas["Pose"];
export type EventKind = Schemas["EventKind"];
export type Action = Schemas["Action"];

export type PlanSummary = Schemas["PlanSummary"];
export type ExampleSummary = Schemas["ExampleSummary"];
export type RunSummary = Schemas["RunSummary"];
export type PlanState = Schemas["PlanState"];
export type Wording = Schemas["Wording"];
export type Findings = Schemas["Findings"];
export type Diagnostic = Schemas["Diagnostic"];
export type AnalysisFound = Schemas["AnalysisFound"];
export type Revision = Schemas["Revision"];
export type MissionChange = Schemas["MissionChange"];
export type CommandDone = Schemas["CommandDone"];
export type VersionSummary = Schemas["VersionSummary"];
export type Member = Schemas["Member"];
export type OrderJob = Schemas["OrderJob"];
export type EvaluationJob = Schemas["EvaluationJob"];
export type EvaluationAsked = Schemas["EvaluationAsked-Input"];
export type EvaluationStanding = Schemas["EvaluationStanding"];
export type RateTold = Schemas["RateTold"];
export type FailedRun = Schemas["FailedRun"];
export type ReplayedRun = Schemas["ReplayedRun"];
export type Problem = Schemas["Problem"];
export type Edit = Schemas["EditPlan"]["edits"][number];
export type ServiceSummary = Schemas["ServiceSummary"];

export type World = Schemas["WorldDescription"];
export type WorldFloor = Schemas["DescribedFloor"];
export type FloorPlan = Schemas["DescribedFloorPlan"];
export type WorldCheckpoint = Schemas["DescribedCheckpoint"];
export type Obstacle = Schemas["Obstacle"];
export type PreviewedMission = Schemas["PreviewedMission"];
export type MissionWay = Schemas["MissionWay"];
export type PreviewedWay = Schemas["PreviewedWay"];
export type MissionReading = Schemas["MissionReading"];

export type Headline = Schemas["Headline"];
export type Noticed = Schemas["Noticed"];
export type VerdictPart = Schemas["VerdictPart"];

export type RunState = Schemas["RunState"];
export type RunAsked = Schemas["RunAsked"];
export type RequestState = Schemas["RequestState"];
export type Entry = Schemas["EntryTold"]["entry"];
/** A fault of a run or an evaluation, as a request gives it. */
export type Fault = Schemas["BeginFault"]["fault"];
export type FaultDescription = Schemas["FaultDescription"];
export type FaultField = Schemas["FaultField"];
export type NumberLimits = Schemas["NumberLimits"];
/** The kind of any fault. */
export type FaultKind = Schemas["BeginFault"]["fault"]["kind"];
export type Trouble = Schemas["Trouble"];
export type RunRequestBody =
  import("./schema").operations["ask_run"]["requestBody"]["content"]["application/json"];

type WebhookMessage<name extends keyof webhooks> =
  webhooks[name]["get"]["responses"][200]["content"]["application/json"];
export type RoomMessage = WebhookMessage<"mission">;
export type RunMessage = WebhookMessage<"robot">;

export type DurationReading = Schemas["DurationReading"];
export type DraftState = Schemas["DraftState"];
export type DraftSummary = Schemas["DraftSummary"];
export type DraftedLine = Schemas["DraftedLine"];
export type DraftAct = Schemas["ActsOnDraft"]["acts"][number];
