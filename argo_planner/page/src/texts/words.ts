/** Technical terms: actions, events, responses. */

import { both } from "./both";
import { numberFormat } from "./number-format";

export const words = both(
  {
    and: "and",
    or: "or",
    action: { START: "Start", WAYPOINT: "Waypoint", MEASURE: "Measure", WAIT: "Wait" },
    event: {
      gas_leak: "gas leak",
      hot_spot: "hot spot",
      abnormal_sound: "abnormal sound",
      platform_alarm: "platform alarm",
      positive_obstacle: "obstacle in the way",
      negative_obstacle: "missing floor plate",
      low_battery: "low battery",
      connection_lost: "connection lost",
      emergency_stop: "emergency stop",
      dysfunction: "malfunction of the robot",
      abnormal_reading: "abnormal reading",
      time_up: "time is up",
      all_clear: "all clear",
      battery_charged: "battery charged",
      connection_restored: "connection restored",
    },
    response: {
      report: "report only",
      pause: "stop and wait",
      return: "return to a dock",
      safe_area: "drive to a safe area",
      abort: "end the mission",
    },
    afterwards: {
      resume: "continue the mission",
      wait: "wait for a person",
      end: "end the mission",
    },
    checkpoint: { "pressure gauge": "pressure gauge", "liquid level gauge": "level gauge", valve: "valve" },
    seconds: (s: number) => duration(s, "en", Math.round),
    boundSeconds: (s: number, toWhole: (value: number) => number) => duration(s, "en", toWhole),
  },
  {
    and: "und",
    or: "oder",
    action: { START: "Start", WAYPOINT: "Wegpunkt", MEASURE: "Messen", WAIT: "Warten" },
    event: {
      gas_leak: "Gasleck",
      hot_spot: "heiße Stelle",
      abnormal_sound: "auffälliges Geräusch",
      platform_alarm: "Plattformalarm",
      positive_obstacle: "Hindernis im Weg",
      negative_obstacle: "fehlende Bodenplatte",
      low_battery: "niedriger Ladestand",
      connection_lost: "Verbindung verloren",
      emergency_stop: "Not-Halt",
      dysfunction: "Fehlfunktion des Roboters",
      abnormal_reading: "auffälliger Messwert",
      time_up: "Zeit abgelaufen",
      all_clear: "Entwarnung",
      battery_charged: "Batterie geladen",
      connection_restored: "Verbindung wiederhergestellt",
    },
    response: {
      report: "nur melden",
      pause: "anhalten und warten",
      return: "zu einer Ladestation zurückkehren",
      safe_area: "in einen sicheren Bereich fahren",
      abort: "die Mission beenden",
    },
    afterwards: {
      resume: "die Mission fortsetzen",
      wait: "auf eine Person warten",
      end: "die Mission beenden",
    },
    checkpoint: { "pressure gauge": "Manometer", "liquid level gauge": "Füllstandsanzeige", valve: "Ventil" },
    seconds: (s: number) => duration(s, "de", Math.round),
    boundSeconds: (s: number, toWhole: (value: number) => number) => duration(s, "de", toWhole),
  },
);

/** Format a time (s) as `1:05:20 h`, `5:20 min` or `12 s`; `toWhole` rounds it. */
function duration(s: number, language: string, toWhole: (value: number) => number): string {
  const tenths = toWhole(10 * s) / 10;
  if (tenths < 60) return `${numberFormat(language, 0, 1).format(tenths)} s`;
  const whole = toWhole(s);
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor((whole % 3600) / 60)];
  const tail = String(whole % 60).padStart(2, "0");
  if (hours === 0) return `${minutes}:${tail} min`;
  return `${hours}:${String(minutes).padStart(2, "0")}:${tail} h`;
}
