"""What stands around sentences in German, besides what does in English: labels are often mixed."""

from dataclasses import replace

from argo_compiler.il import Mode, Order
from argo_compiler.script.syntax.words import english_prose

LABELS = {
    "designation": "bezeichnung|bezeichnung der mission|missionsbezeichnung|name der mission|name",
    "mode": "betriebsart|modus|hauptmodus|missionsmodus",
    "max_duration": (
        "maximale dauer|maximale missionsdauer|maximale dauer der mission|max. dauer|"
        "max. missionsdauer|max dauer|maximaldauer|höchstdauer|zeitlimit|dauer|maximale zeit|"
        "maximale gesamtdauer|zeitbegrenzung"
    ),
    "order": "reihenfolge|reihenfolge der kontrollpunkte|ablauf",
    "anomaly_specification": "anomalien|spezifikation von anomalien|anomaliespezifikation",
    "real_time_reporting": "echtzeitmeldung|echtzeitmeldungen|meldungen in echtzeit",
    "after_mission_report": "bericht nach der mission|abschlussbericht|bericht",
    "initial_position": "anfangsposition|startposition|startpunkt|start|beginn",
    "end_of_mission": "ende der mission|missionsende|ende|ziel|endposition|zielposition",
    "site": "anlage|standort|werk",
    "start_area": "startbereich",
    "end_area": "endbereich|zielbereich",
    "dock": "dockingstation",
    "current": "aktuell",
    "left_out": "ausgelassen",
    "steps": (
        "kontrollpunkte|zu prüfende kontrollpunkte|zu lesende kontrollpunkte|prüfpunkte|schritte|"
        "aufgaben|ablauf der mission"
    ),
    "nothing": "von|an|kopie|betreff|datum|autor|verfasser|erstellt von|bediener|version|stand",
}

_ENGLISH = english_prose.PROSE


def _both(german: str, english: str) -> str:
    return f"{german}|{english}"


PROSE = replace(
    _ENGLISH,
    labels={name: _both(text, _ENGLISH.labels[name]) for name, text in LABELS.items()},
    values={
        ("order", Order.ANY): _both(
            "beliebig|beliebige reihenfolge|in beliebiger reihenfolge|frei|egal",
            _ENGLISH.values["order", Order.ANY],
        ),
        ("order", Order.PRECISE): _both(
            "genau|genaue reihenfolge|in dieser reihenfolge|genau in dieser reihenfolge|fest|"
            "wie angegeben|wie aufgeführt|in der angegebenen reihenfolge",
            _ENGLISH.values["order", Order.PRECISE],
        ),
        ("mode", Mode.AUTONOMOUS): _both(
            "autonom|autonomer betrieb|autonomer modus", _ENGLISH.values["mode", Mode.AUTONOMOUS]
        ),
        ("mode", Mode.SUPERVISORY): _both(
            "überwacht|beaufsichtigt|überwachter betrieb",
            _ENGLISH.values["mode", Mode.SUPERVISORY],
        ),
        ("none", None): _both(
            "keine|keiner|kein|keines|nein|unbegrenzt|ohne grenze", _ENGLISH.values["none", None]
        ),
        ("as planned", None): _both("wie geplant", _ENGLISH.values["as planned", None]),
    },
    around_areas=_both(
        "der|die|das|den|dem|des|ein|eine|roboter|ist|steht|befindet|sich|wird|und|in|im|an|am|bei|"
        "von|auf|sein|seine|seiner|ihre|zu|zum|zur|dockingstation|dock|mission|endet|ende|wenn|"
        "geparkt|angedockt|beginnt|beginn|startet|start|kehrt|fährt|zurück|dort|vor|nach|vorher|"
        "lädt|geladen|wartet|danach|zuerst|schließlich|position|dann",
        _ENGLISH.around_areas,
    ),
    columns={
        name: _both(text, _ENGLISH.columns[name])
        for name, text in {
            "number": "nr.|nummer|schritt|pos.",
            "checkpoint": "kontrollpunkt|prüfpunkt|messpunkt|kontrollpunkt nr|punkt",
            "object": "ablesung|objekt|bezeichnung|messgerät|gerät|was|ventil|anzeige",
            "action": "aktion|aufgabe|tätigkeit|auftrag|zu tun|anweisung",
            "priority": "priorität|wichtigkeit",
            "optional": "wahlweise",
            "speed": "geschwindigkeit",
            "remark": "bemerkung|bemerkungen|kommentar|anmerkung|hinweis|bedingung",
            "nothing": "stock|stockwerk|etage|ort|erledigt|ergebnis",
        }.items()
    },
    ranks={
        "3": _both("hoch|sehr wichtig|wichtig", _ENGLISH.ranks["3"]),
        "2": _both("mittel", _ENGLISH.ranks["2"]),
        "1": _both("niedrig|gering", _ENGLISH.ranks["1"]),
    },
    yes=_both("ja|j", _ENGLISH.yes),
    greeting=_both(
        "hallo|guten morgen|guten tag|guten abend|liebe|lieber|liebes|sehr geehrte|sehr geehrter|"
        "moin|servus|grüß gott|grüezi",
        _ENGLISH.greeting,
    ),
    closing=_both(
        "viele grüße|mit freundlichen grüßen|freundliche grüße|beste grüße|liebe grüße|grüße|gruß|"
        "viele gruesse|mit freundlichen gruessen|gruss|danke|vielen dank|danke schön|besten dank|"
        "mfg|schönes wochenende|schönen tag noch|schönen feierabend",
        _ENGLISH.closing,
    ),
    occasion=_both("für|während|anlässlich|im rahmen", _ENGLISH.occasion),
    section=_both(
        "änderungen|änderung|aufgaben|aufgabe|schritte|plan|runde|rundgang|abschnitt|teil|mission|"
        "aufträge|anweisungen|ablauf",
        _ENGLISH.section,
    ),
    listing=_both("{die} folgende{n}|diese|die", _ENGLISH.listing),
    remark=_both(
        "hinweis|hinweise|anmerkung|anmerkungen|bemerkung|bemerkungen|kommentar|notiz|notizen|"
        "achtung|hintergrund|grund|übrigens|bitte beachten|zur information|info",
        _ENGLISH.remark,
    ),
    small_talk=_both(
        "könntet ihr den roboter|könnten sie den roboter|könntest du den roboter|"
        "ich hoffe|wir hoffen|wie besprochen|wie vereinbart|anbei|hier ist|hier sind|im anhang|"
        "bei fragen|falls es fragen gibt|vielen dank|danke|entschuldigung|unten steht|das ist der|"
        "das ist die|das sind die|es geht um",
        _ENGLISH.small_talk,
    ),
    reason=_both("weil|denn|da der|da die|da das|da es|damit|um", _ENGLISH.reason),
    counted=_both("patrouille|messung|prüfung|fahrt", _ENGLISH.counted),
    preposition=_both(
        "von|vom|an|am|in|im|auf|für|zu|zum|zur|aus|mit|bei|beim|durch|nach|vor|während|und|oder|"
        "nahe|um|über|unter|zwischen|pro|ohne|innerhalb|entlang|hinter|neben|ist|sind|war|waren|"
        "es|sein|gegen|seit|bis|ab",
        _ENGLISH.preposition,
    ),
    determiner=_both(
        "der|die|das|den|dem|des|ein|eine|einen|einem|einer|eines|alle|allen|jeden|jedes|jede|"
        "mein|meine|unser|unsere|dein|deine|ihr|ihre|sein|seine|dieser|diese|dieses|diesen|es|"
        "ihn|sie|alles",
        _ENGLISH.determiner,
    ),
    explicit_title=_both(
        "missionsprotokoll|missionsblatt|missionsauftrag|auftrag|prüfauftrag|inspektionsauftrag",
        _ENGLISH.explicit_title,
    ),
    left_open=_both(
        "die dockingstation{en} {ist} {sind} {wird} {werden} gewählt|"
        "die startbereiche werden gewählt|der startbereich wird gewählt",
        _ENGLISH.left_open,
    ),
    sheet=_both(
        "normale|werte|stellung|stellungen|stand|regeln|regel|anhang|anomalie|vorbereitung|"
        "parameter|personal|während|bericht|gemeldet|liste|einmal|sobald|gefunden|mehr|gesamte|"
        "außerhalb|bereich|zustände|katalog|genau",
        _ENGLISH.sheet,
    ),
    no=_both("nein|muss|pflicht|erforderlich", _ENGLISH.no),
    say={
        "checkpoint": "Kontrollpunkt",
        "priority": "mit Priorität",
        "optional": "falls Zeit ist",
        "speed": "mit",
    },
    samples={
        "MEASURE": "prüfe Kontrollpunkt 4",
        "KEEP_MEASURING": "lies laufend Kontrollpunkt 4, bis der Wert unter 3 liegt",
        "GO": "fahre zu Startbereich 2",
        "HOME": "kehre zur Dockingstation in Startbereich 1 zurück",
        "START": "starte in Startbereich 1",
        "PATROL": "patrouilliere den zweiten Stock 10 Minuten lang",
        "WAIT": "warte 90 s",
        "PAUSE": "wenn ein Gasleck erkannt wird, halte an",
        "REPEAT": "wiederhole Schritte 2 bis 4 dreimal",
        "ADD": "füge Kontrollpunkt 4 nach Kontrollpunkt 2 ein",
        "DELETE": "lösche Kontrollpunkt 4",
        "REPLACE": "ersetze Kontrollpunkt 4 durch Kontrollpunkt 5",
        "MOVE": "verschiebe Kontrollpunkt 4 vor Kontrollpunkt 2",
        "JUMP": "springe zu Schritt 5",
        "RETRY": "prüfe Kontrollpunkt 4. Wenn das fehlschlägt, versuche es zweimal",
        "IF": "wenn der Wert über 5 liegt, prüfe Kontrollpunkt 4",
        "UNLESS": "prüfe Kontrollpunkt 4, es sei denn Kontrollpunkt 2 ist auffällig",
        "ELSE": "wenn der Wert über 5 liegt, fahre fort, sonst prüfe Kontrollpunkt 4",
    },
)
