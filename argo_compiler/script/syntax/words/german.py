"""The words of German, with the terminals and values of the English ones.

`kehre … zurück` are two words with others between them. Each phrase is found with `ae` for `ä`, and
so on, as well.
"""

from argo_compiler.il import EventKind, Mode
from argo_compiler.script.syntax.tree.nouns import Kind
from argo_compiler.script.syntax.words.lexicon import Phrases, expand
from argo_compiler.script.syntax.words.numbers import Figure


def _forms(stems: str) -> str:
    """The forms of weak verbs: `prüfe`, `prüft`, `prüfen`, `prüfen sie`."""
    return "|".join(f"{s}{{e}}|{s}t|{s}st|{s}en {{sie}}" for s in stems.split())


def _parted(particle: str, forms: str) -> str:
    """The forms of a verb that is parted, of which the last one is its infinitive: `lies … ab`,
    `ablesen`, `abzulesen`."""
    *finite, infinitive = forms.split()
    parted = [f"{form} … {particle}" for form in (*finite, infinitive, f"{infinitive} sie")]
    whole = [f"{particle}{form}" for form in (*finite, infinitive, f"zu{infinitive}")]
    return "|".join((*parted, *whole))


def _passive(participles: str) -> str:
    """`wird … geprüft`, `muss … geprüft werden`."""
    return "|".join(
        f"wird … {p}|werden … {p}|muss … {p} werden|müssen … {p} werden|soll … {p} werden|"
        f"sollen … {p} werden|sollte … {p} werden|ist … {p}|sind … {p}|{p} werden"
        for p in participles.split()
    )


_DRIVE = "fahr fahre fährt fahrt fahren"
_TURN = "kehr kehre kehrt kehren"
_COME = "komm komme kommt kommen"
_GO = "geh gehe geht gehen"

NOTHING: Phrases = {
    ("FILLER", None): (
        "der|die|das|den|dem|des|ein|eine|einen|einem|einer|eines|bitte|dann|erst|erstmal|danach|"
        "anschließend|"
        "daraufhin|zuerst|zunächst|schließlich|zuletzt|abschließend|zum schluss|am schluss|am ende|"
        "als nächstes|als erstes|im anschluss|hierauf|nun|jetzt|auch|ebenfalls|ebenso|sofort|"
        "unverzüglich|umgehend|gleich|direkt|einfach|roboter{s}|soll|sollen|sollte|muss|müssen|wir|"
        "du|dir|so|also|von dort|von da|von dort aus|davon|dort|lass|lasst|lassen sie|könntest du|"
        "könnten sie|könnt ihr|kannst du|können sie|würdest du|würden sie|ich möchte , dass|"
        "wir möchten , dass|ich hätte gern , dass|es muss|es müssen|es soll|es sollen|lang|hin|mir"
    ),
    ("IDLE", None): (
        "heute|heute nacht|heute abend|heute früh|heute morgen|heute vormittag|heute nachmittag|"
        "morgen|morgen früh|vorsichtig|sorgfältig"
    ),
}

VERBS: Phrases = {
    ("MEASURE", None): (
        f"{_forms('prüf überprüf kontrollier inspizier untersuch erfass protokollier überwach')}|"
        f"{_forms('begutacht')}|begutachte|begutachtet|miss|misst|messe|messen {{sie}}|"
        "lies|liest|lest|lese|lesen {sie}|nachsehen bei|zu prüfen|"
        f"{_parted('ab', 'lies liest lest lese lesen')}|{_parted('aus', 'lies liest lest lesen')}|"
        f"{_parted('an', 'sieh sieht seht sehe sehen')}|"
        f"{_parted('an', 'schau schaut schaue schauen')}|"
        f"{_parted('auf', 'nimm nimmt nehmt nehmen')}|wirf einen blick auf|"
        f"werfen sie einen blick auf"
    ),
    ("KEEP_MEASURING", None): (
        "prüfe laufend|prüfe fortlaufend|prüfe weiter|lies laufend|lies weiter|"
        "laufend prüfen|laufend ablesen|fortlaufend prüfen|weiter prüfen|weiter ablesen"
    ),
    ("BE_MEASURED", None): (
        f"{_passive('geprüft überprüft kontrolliert gelesen abgelesen gemessen inspiziert')}|"
        "ist … zu prüfen|ist … zu messen|ist … abzulesen|sind … zu prüfen|sind … abzulesen"
    ),
    ("GO", None): (
        "fahr|fahre|fährt|fahrt|fahren {sie}|geh|gehe|geht|gehen {sie}|begib dich|begibt sich|"
        "begeben sie sich|bewege dich|bewegt sich|steuere … an|steuert … an|ansteuern|"
        "fahre … an|fährt … an|anfahren|hinfahren|rolle|rollt|rollen"
    ),
    ("HOME", None): (
        "fahr{e} nach hause|fährt nach hause|fahren sie nach hause|fahre heim|fährt heim|"
        "heimfahren|"
        "geh{e} nach hause|geht nach hause|komm{e} nach hause|kommt nach hause|nach hause fahren|"
        "nach hause|kehr{e} heim|kehrt heim|heimkehren|heim|"
        f"{_parted('an', 'dock docke dockt docken')}|"
        "zurück zur basis|fahre zurück zur basis|nach hause gehen|nach hause kommen"
    ),
    ("START", None): (
        f"{_forms('start beginn')}|starte|startet|starten|starten sie|{_parted('los', _DRIVE)}|"
        "setze einen startpunkt|setze den startpunkt|setze startpunkt|lege den startpunkt fest|"
        f"{_parted('ab', _DRIVE)}|steht|wartet zu beginn|verlässt|verlasse|verlassen"
    ),
    ("PATROL", None): (
        f"{_forms('patrouillier')}|{_parted('ab', 'patrouilliere patrouilliert patrouillieren')}|"
        "patrouilliere durch|patrouilliert durch|patrouillieren durch|patrouille|"
        "fahre … patrouille|"
        "fährt … patrouille|bestreife|bestreifen|durchstreife|durchstreifen|mache eine patrouille"
    ),
    ("WAIT", None): (
        "warte|wartet|warten {sie}|warte … ab|wartet … ab|warten sie … ab|abwarten|bleibe|bleibt|"
        "bleib|bleiben {sie}|bleib{e} stehen|bleibt stehen|verweile|verweilt|verweilen"
    ),
    ("PAUSE", None): (
        f"{_forms('pausier stopp')}|{_parted('an', 'halt halte hält haltet halten')}|halt|"
        "halte die runde an|unterbrich die runde|unterbricht die runde|unterbreche die runde|"
        "steh still|steht still|stillstehen|stehen bleiben|anzuhalten"
    ),
    ("END", None): (
        "beende die mission|beendet die mission|beenden sie die mission|die mission beenden|"
        "mission beenden|ende|beende den einsatz|den einsatz beenden|beende|beenden|"
        "stoppe die mission|die mission endet|ende der mission|damit endet die mission|"
        "das ist das ende der mission|schließe die mission ab"
    ),
    ("ABORT", None): (
        "brich ab|breche ab|bricht ab|brechen sie ab|abbrechen|brich die mission ab|"
        "breche die mission ab|bricht die mission ab|brechen sie die mission ab|"
        "die mission abbrechen|mission abbrechen|die mission wird abgebrochen|"
        "mission wird abgebrochen|brich den einsatz ab"
    ),
    ("GO_ON", None): (
        f"{_parted('fort', _DRIVE)}|{_parted('weiter', 'mach mache macht machen')}|"
        f"{_parted('weiter', _DRIVE)}|setze … fort|setzt … fort|setzen sie … fort|"
        "weiter|setze die mission fort|die mission fortsetzen|mission fortsetzen|fortsetzen|"
        "die mission fortführen|nimm die mission wieder auf"
    ),
    ("RECHARGE", None): (
        f"lade|lädt|laden {{sie}}|{_parted('auf', 'lade lädt laden')}|lade den akku|"
        "lade den akku auf|lädt den akku auf|den akku laden|den akku aufladen|akku laden|"
        "akku aufladen|lade ihn auf|lade ihn|ihn aufladen|ihn laden|lade sie auf|"
        "lade die batterie auf|lade die batterie|die batterie laden|"
        "die batterie aufladen|batterie laden|batterie aufladen|lade nach|nachladen|lädt nach"
    ),
    ("REPORT", None): (
        "melde es|meldet es|melden sie es|melde das|melde dies|melde|meldet|melden|es melden|"
        "das melden|dies melden|berichte es|berichte das|berichte|berichten|melde ihn|ihn melden|"
        "teile es mit|teile das mit|mitteilen"
    ),
    ("REPEAT", None): (
        f"{_forms('wiederhol')}|{_parted('durch', 'führ führe führt führen')}|"
        f"{_parted('aus', 'führ führe führt führen')}"
    ),
    ("DO_FOLLOWING", None): (
        "mach folgendes|mache folgendes|tu folgendes|tue folgendes|führe folgendes aus|"
        "gehe wie folgt vor|geh wie folgt vor|folgendes tun"
    ),
    ("ADD", None): (
        f"{_parted('ein', 'füg füge fügt fügen')}|{_parted('hinzu', 'füg füge fügt fügen')}|"
        "ergänze|ergänzt|ergänzen {sie}"
    ),
    ("DELETE", None): (
        "ignoriere|ignoriert|ignorieren|überspringe|überspringt|überspringen|"
        f"{_parted('aus', 'lass lasse lässt lassen')}|"
        f"lösche|löscht|löschen {{sie}}|entferne|entfernt|entfernen {{sie}}|"
        f"{_forms('streich')}|{_parted('heraus', 'nimm nimmt nehmt nehmen')}"
    ),
    ("REPLACE", None): (
        "ersetze|ersetzt|ersetzen {sie}|tausche|tauscht|tauschen {sie}|"
        f"{_parted('aus', 'tausche tauscht tauschen')}"
    ),
    ("MOVE", None): "verschieb{e}|verschiebt|verschieben {sie}|schieb{e}|verlege|verlegen",
    ("JUMP", None): (
        "spring{e} zu|springt zu|springen sie zu|weiter mit|fahre fort mit|fährt fort mit|"
        "mach{e} weiter mit|macht weiter mit|weitermachen mit|weiter bei|fortfahren mit|"
        "geh{e} weiter zu|weiter zu|überspringe alles bis|überspringe bis"
    ),
    ("RETRY", None): (
        "versuche es {noch}|versuch es {noch}|versuchen sie es {noch}|es versuchen|"
        "nochmals versuchen|versuche es noch einmal|versuche es nochmal|versuche es noch mal|"
        "versuche es erneut|"
        "versuch es noch einmal|versuch es nochmal|versuch es erneut|noch einmal versuchen|"
        "nochmal versuchen|erneut versuchen|es erneut versuchen|es noch einmal versuchen|"
        "versuchen sie es erneut|versuchen sie es noch einmal|es nochmal versuchen|"
        "versucht es erneut|versucht es noch einmal"
    ),
    ("DONE", None): "fertig|das ist alles|das war alles|das wäre alles",
    ("MEET", None): "hier weiter|ab hier weiter|hier geht es weiter",
    ("START_HERE", None): "starte hier|start hier|beginne hier|beginn hier",
    ("MAX_DURATION", None): (
        "die mission darf … dauern|mission darf … dauern|sie darf … dauern|"
        "es darf … dauern|die mission darf dauern|mission darf dauern|mission dauert|"
        "die mission dauert|"
        "die mission darf|mission darf|maximale dauer der mission ist|maximale dauer ist|"
        "maximaldauer ist|höchstdauer ist|maximale dauer der mission beträgt|"
        "maximale dauer beträgt|höchstdauer beträgt|"
        "bitte beachte dass die maximale dauer der mission beträgt"
    ),
    ("KEEP_ORDER", None): "behalte bei|halte ein|mache immer",
    ("BACK_IN", None): "muss zurück sein in|roboter muss zurück sein in|er muss zurück sein in",
    ("ROUND_DRIVEN", None): (
        "sind eine runde die gefahren wird|werden gefahren|werden wiederholt|sind eine runde"
    ),
}

NOUNS: Phrases = {
    ("KIND", (Kind.CHECKPOINT, False)): (
        "kontrollpunkt{s}|kontrollpunktes|kp|prüfpunkt{s}|messpunkt{s}|checkpoint|prüfstelle|"
        "messstelle"
    ),
    ("KIND", (Kind.CHECKPOINT, True)): (
        "kontrollpunkte{n}|prüfpunkte{n}|messpunkte{n}|checkpoints|prüfstellen|messstellen"
    ),
    ("KIND", (Kind.VALVE, False)): "ventil{s}|absperrventil{s}|armatur",
    ("KIND", (Kind.VALVE, True)): "ventile{n}|absperrventile{n}|armaturen",
    ("KIND", (Kind.PRESSURE_GAUGE, False)): "druckanzeige|manometers|druckmanometers|druckmessers",
    ("KIND", (Kind.PRESSURE_GAUGE, True)): (
        "druckanzeigen|manometern|druckmanometern|druckmessern|druckmessgeräte{n}"
    ),
    ("KIND", (Kind.LIQUID_LEVEL_GAUGE, False)): (
        "füllstandsanzeige|füllstandanzeige|flüssigkeitsstandanzeige|flüssigkeitsstandsanzeige|"
        "pegelanzeige|füllstandsmessgerät"
    ),
    ("KIND", (Kind.LIQUID_LEVEL_GAUGE, True)): (
        "füllstandsanzeigen|füllstandanzeigen|flüssigkeitsstandanzeigen|flüssigkeitsstandsanzeigen|"
        "pegelanzeigen|füllstandsmessgeräte{n}"
    ),
    ("KIND", (Kind.GAUGE, False)): "messgerät|anzeige|messinstrument|messuhr",
    ("KIND", (Kind.GAUGE, True)): "messgeräte{n}|anzeigen|messinstrumente{n}|messuhren",
    ("HASH", None): "#|nr .|nr|nummer|nummern|no .|no",
    ("STEP", None): "schritt{s}|schritte{n}|schrittes|aufgabe{n}",
    ("NEXT_STEP", None): "[nächsten/nächste/nächster/folgenden/folgende] [schritt/punkt/aufgabe]",
    ("FLOOR", False): "stock{s}|stockes|stockwerk{s}|etage|geschoss{es}|ebene|deck{s}",
    ("FLOOR", True): "stockwerke{n}|etagen|geschosse{n}|ebenen|stöcke",
    ("FLOOR_NAME", "bottom"): (
        "erdgeschoss{es}|eg|unterste etage|untersten etage|unterster stock|untersten stock|"
        "unterstes stockwerk|unterste stockwerk|untersten stockwerk|unterste ebene|untersten ebene"
    ),
    ("FLOOR_NAME", "top"): (
        "oberste etage|obersten etage|oberster stock|obersten stock|oberstes stockwerk|"
        "oberste stockwerk|obersten stockwerk|oberste ebene|obersten ebene|oberstes geschoss|"
        "oberste geschoss|obersten geschoss"
    ),
    ("AREA", None): "startbereich{s}|startzone|startfläche|bereich{s}",
    ("DOCK", None): (
        "dockingstation|docking-station|docking station|dock|ladestation|dockstation|andockstation|"
        "seine dockingstation|seiner dockingstation"
    ),
    ("ROUNDS_OF", None): "[runden/rundgänge/patrouillen] [durch/auf/um/in]",
    ("PARK", None): "park|parke|parkt|parken",
    ("ALL", None): "alle{n}|aller|sämtliche{n}|jedes|jeden|jede|jeder|jedem",
    ("EXCEPT", None): (
        "außer|ausser|mit ausnahme von|mit ausnahme|bis auf|ausgenommen|abgesehen von|aber nicht|"
        "jedoch nicht|nicht aber|nur nicht"
    ),
    ("IT", None): (
        "es|ihn|sie … liegt|sie … ist|sie … steigt|sie … fällt|sie … sinkt|er … liegt|er … ist|"
        "er … steigt|er … fällt|er … sinkt"
    ),
    ("THEM", "either"): (
        "[einer/eine/eines/eins] [davon/von ihnen/von beiden/von diesen]|"
        "mindestens [einer/eine/eines/eins] [davon/von ihnen/von beiden]"
    ),
    ("BOTH", None): "beide{n}|sie beide|alle beide",
    ("THEM", None): ("sie … liegen|sie … sind|sie … steigen|sie … fallen|sie … sinken"),
    (
        "THIS",
        None,
    ): "dieser|diese|dieses|diesen|diesem|dies|die ablesung|die messung|die prüfung|der versuch",
    ("OF", "value"): ("[wert/werte/messwert/messwerte/anzeige] [von/vom/an/am/bei/beim/auf]"),
    ("OF", "position"): "[stellung/stellungen/position] [von/vom/an/am]",
    ("OF", "level"): "[füllstand/füllstände/pegel/stand] [von/vom/an/am/bei/auf]",
    ("OF", "pressure"): "[druck/drücke] [von/vom/an/am/bei/beim/auf]",
    ("VALUE", "value"): "sein wert|ihr wert|dessen wert|deren wert",
    ("VALUE", "pressure"): "sein druck|ihr druck|dessen druck|deren druck",
    ("VALUE", "level"): "sein füllstand|ihr füllstand|dessen füllstand|deren füllstand",
    ("VALUE", "position"): "seine stellung|ihre stellung|dessen stellung|deren stellung",
    **{
        ("ORDINAL", n): f"{word}e|{word}en|{word}er|{word}es|{word}em"
        for n, word in enumerate(
            expand("erst|zweit|dritt|viert|fünft|sechst|siebt|acht|neunt|zehnt"), start=1
        )
    },
}

CONDITIONS: Phrases = {
    ("IF", None): (
        "wenn|falls|sobald|sofern|immer wenn|jedes mal wenn|für den fall dass|im fall{e}|"
        "im falle einer|im falle eines|nur wenn|nur falls|wird … erkannt|wird … gemeldet|"
        "wird … entdeckt|wird … festgestellt|tritt … auf|sollte … liegen|sollte … sein|"
        "sollte … steigen|sollte … fallen|sollte … sinken"
    ),
    ("UNLESS", None): "es sei denn {,}|es sei denn , dass|außer wenn|außer , wenn|sofern nicht",
    ("ELSE", None): "sonst|ansonsten|andernfalls|anderenfalls|wenn nicht ,|falls nicht ,",
    (
        "IN_ALL_OTHERS",
        None,
    ): "in allen anderen fällen|in allen übrigen fällen|in jedem anderen fall",
    ("LAST_ROUND", None): "nach der letzten runde",
    ("TOO_LATE", None): "es zu spät ist|es dafür zu spät ist|zu spät|es zu spät dafür ist",
    ("OLDER", None): "älter als",
    ("UNTIL", None): "bis|bis zur|bis zum|so lange bis|solange bis",
    ("IS", None): (
        "ist|sind|liegt|liegen|steigt|steigen|fällt|fallen|sinkt|sinken|wird|werden|war|waren|"
        "zeigt|zeigen|anzeigt|beträgt"
    ),
    ("NOT", None): "nicht|kein|keine|keinen|nie|niemals",
    ("GREATER", None): (
        "über|größer als|mehr als|höher als|oberhalb von|oberhalb|>|größer|einen wert über|"
        "einen wert von mehr als|übersteigt|überschreitet|übersteigen|überschreiten"
    ),
    ("LESS", None): (
        "unter|kleiner als|weniger als|niedriger als|geringer als|unterhalb von|unterhalb|<|"
        "einen wert unter|einen wert von weniger als|unterschreitet|unterschreiten"
    ),
    ("AT_LEAST", None): (
        "mindestens|wenigstens|>=|größer oder gleich|größer gleich|nicht weniger als|"
        "nicht kleiner als"
    ),
    ("AT_MOST", None): (
        "höchstens|maximal|<=|kleiner oder gleich|kleiner gleich|nicht mehr als|nicht größer als|"
        "nicht länger als|bis zu"
    ),
    ("TAKING", None): "wobei es höchstens dauert|dauer höchstens",
    ("MINUS", None): "minus",
    ("BETWEEN", None): "zwischen",
    ("FROM", None): "von|vom|aus|ab",
    ("STATE", "normal"): (
        "normal|unauffällig|im normalbereich|in seinem normalbereich|in ihrem normalbereich|"
        "im normalen bereich|in normalstellung|in seiner normalstellung"
    ),
    ("STATE", "abnormal"): (
        "auffällig|abnormal|anormal|unnormal|nicht normal|außerhalb des normalbereichs|"
        "außerhalb seines normalbereichs|außerhalb ihres normalbereichs|nicht im normalbereich|"
        "nicht in seinem normalbereich|nicht in ihrem normalbereich|nicht in normalstellung|"
        "nicht in seiner normalstellung"
    ),
    ("STATE", "unreadable"): (
        "unlesbar|nicht lesbar|nicht ablesbar|nicht abgelesen werden kann|"
        "nicht gelesen werden kann|nicht abzulesen|nicht zu lesen"
    ),
    ("FAILS", None): (
        "fehlschlägt|fehlgeschlagen ist|fehlgeschlagen|scheitert|gescheitert ist|misslingt|"
        "nicht gelingt|nicht klappt|nicht funktioniert|weiterhin fehlschlägt|"
        "immer noch fehlschlägt|erneut fehlschlägt|wieder fehlschlägt|nicht gelungen ist"
    ),
    ("OCCURS", None): (
        "erkannt wird|gemeldet wird|entdeckt wird|festgestellt wird|gefunden wird|gehört wird|"
        "gesehen wird|bemerkt wird|auftritt|eintritt|ertönt|erklingt|vorliegt|besteht|"
        "gedrückt wird|ausgelöst wird|auftaucht|zu hören ist|kommt|erkannt werden|auftreten"
    ),
    ("BATTERY", None): (
        "akku|akkus|batterie|akkustand{s}|ladestand{s}|akkuladung|batteriestand{s}|"
        "ladestand des akkus|ladestand der batterie|ladung des akkus|ladung der batterie"
    ),
    ("EVENT", EventKind.GAS_LEAK): "gasleck{s}|gaslecks|gasaustritt{s}|gasleckage|gasleckagen",
    ("EVENT", EventKind.HOT_SPOT): (
        "heiße stelle|heißen stelle|heiße stellen|heißer stelle|hotspot{s}|hot spot{s}|überhitzung"
    ),
    ("EVENT", EventKind.ABNORMAL_SOUND): (
        "ungewöhnliches {pumpen}geräusch|ungewöhnlichen {pumpen}geräusch|"
        "auffälliges {pumpen}geräusch|"
        "auffälligen {pumpen}geräusch|ungewöhnlichem {pumpen}geräusch|auffälligem {pumpen}geräusch|"
        "abnormales {pumpen}geräusch|abnormalen {pumpen}geräusch"
    ),
    ("EVENT", EventKind.PLATFORM_ALARM): (
        "plattformalarm{s}|allgemeiner plattformalarm|allgemeinen plattformalarm|"
        "allgemeinem plattformalarm|gpa|räumungsalarm|evakuierungsalarm|räumungsalarm ( gpa )"
    ),
    ("EVENT", None): "hindernis|hindernisse|hindernisses|hindernissen",
    ("EVENT", EventKind.POSITIVE_OBSTACLE): (
        "positives hindernis|positiven hindernis|positivem hindernis|positive hindernisse"
    ),
    ("EVENT", EventKind.NEGATIVE_OBSTACLE): (
        "negatives hindernis|negativen hindernis|negativem hindernis|negative hindernisse"
    ),
    ("EVENT", EventKind.LOW_BATTERY): (
        "akku schwach|schwacher akku|schwachem akku|schwachen akku|niedriger akkustand|"
        "niedrigem akkustand|schwache batterie|schwacher batterie|akku ist schwach|"
        "akku schwach ist|batterie schwach ist|batterie schwach|akku leer wird|akku fast leer ist"
    ),
    ("EVENT", EventKind.CONNECTION_LOST): (
        "verbindung verloren|verbindungsverlust{es}|verbindungsabbruch{s}|verbindung abbricht|"
        "verbindung verloren geht|verbindung abreißt|verbindung verloren ist|"
        "verlust der verbindung|"
        "abbruch der verbindung"
    ),
    ("EVENT", EventKind.EMERGENCY_STOP): "not-halt|nothalt|not-aus|notaus|not-stopp|notstopp",
    ("EVENT", EventKind.DYSFUNCTION): "störung|fehlfunktion|defekt|funktionsstörung",
    ("EVENT", EventKind.ABNORMAL_READING): (
        "auffälliger wert|auffälligen wert|auffälligem wert|auffälliger messwert|"
        "auffälligen messwert|auffälligem messwert|abnormaler wert|abnormalen wert|"
        "ein wert auffällig ist|ein messwert auffällig ist|irgendein wert auffällig ist|"
        "ein wert außerhalb des normalbereichs liegt|"
        "irgendein wert außerhalb des normalbereichs liegt"
    ),
    (
        "EVENT",
        EventKind.TIME_UP,
    ): "zeit um ist|zeit abgelaufen ist|ablauf der zeit|zeit ist um|zeit um",
    ("EVENT", EventKind.ALL_CLEAR): (
        "entwarnung|entwarnung gegeben wird|gefahr vorüber ist|gefahr vorbei ist|entwarnung kommt"
    ),
    ("EVENT", EventKind.BATTERY_CHARGED): (
        "akku geladen ist|akku voll ist|akku aufgeladen ist|akku voll geladen ist|"
        "batterie geladen ist|batterie voll ist|akku geladen|akku voll|batterie aufgeladen ist"
    ),
    ("EVENT", EventKind.CONNECTION_RESTORED): (
        "verbindung wieder da ist|verbindung wiederhergestellt ist|sie wieder da ist|"
        "sie wiederhergestellt ist|verbindung wieder besteht|verbindung wieder steht"
    ),
}

MANNERS: Phrases = {
    ("TO", None): "zu|zum|zur|ins|in richtung|richtung|bis an",
    ("IN", None): "in|im|innerhalb des|innerhalb der",
    ("AT", None): (
        "an|am|bei|beim|mit einer geschwindigkeit von|mit der geschwindigkeit|mit geschwindigkeit|"
        "bei einer geschwindigkeit von"
    ),
    ("ON", None): "auf",
    ("FOR", None): "für|während|über einen zeitraum von|für die dauer von|auf die",
    ("PERSON", None): "bediener{s}|person|aufsicht|leitwarte",
    ("EVERY", None): "im abstand von|in abständen von|im takt von|immer alle",
    ("TIMES", Figure(1.0)): "einmal|ein mal|ein einziges mal",
    ("TIMES", Figure(2.0)): "zweimal",
    ("MORE", Figure(1.0)): (
        "nochmal|noch mal|noch einmal|nochmals|erneut|abermals|wieder|ein weiteres mal|"
        "ein zweites mal|wiederum"
    ),
    ("TIMES", Figure(3.0)): "dreimal",
    ("MORE_WORD", None): "weitere{n}|zusätzliche{n}|weiteres",
    ("OR_MORE", "or"): "oder [mehr/höher/darüber]",
    ("OR_MORE", "and"): "und [mehr/höher/darüber]",
    ("OR_LESS", "or"): "oder [weniger/niedriger/darunter]",
    ("OR_LESS", "and"): "und [weniger/niedriger/darunter]",
    ("EXACTLY", None): "genau|exakt",
    ("TIME_WORD", None): "mal|male|malen|- mal|runde{n}|durchgänge{n}|durchgang",
    (
        "WITHIN",
        None,
    ): "innerhalb von|innerhalb|binnen|innerhalb der ersten|in den ersten|in höchstens",
    ("MEASURING", None): "messung von|prüfung von|messung an|prüfung an|ablesung von",
    ("EVERYTHING", None): "alles|alle schritte|das ganze",
    ("BY", None): "durch|mit|gegen",
    ("BEFORE", None): "vor|bevor",
    ("AFTER", None): "nach|hinter",
    ("LATEST", None): "spätestens nach|nicht später als|spätestens|spätestens bis",
    ("SINCE_START", None): (
        "nach dem start|nach missionsstart|nach missionsbeginn|nach beginn|"
        "nach dem beginn der mission|"
        "nach beginn der mission|nach dem start der mission"
    ),
    ("IF_TIME", None): (
        "wenn {noch} zeit ist|falls {noch} zeit ist|sofern {noch} zeit ist|wenn {noch} zeit bleibt|"
        "falls {noch} zeit bleibt|sofern {noch} zeit bleibt|wenn die zeit {noch} reicht|"
        "falls die zeit {noch} reicht|sofern die zeit {noch} reicht|wenn es die zeit erlaubt|"
        "wenn die zeit es erlaubt|falls die zeit es erlaubt"
    ),
    ("PRIORITY", None): "mit priorität|mit der priorität|priorität|mit wichtigkeit|wichtigkeit",
    ("RANKED", 3): "[mit/] [hoher/höchster] priorität|priorität hoch|mit priorität hoch",
    ("RANKED", 2): ("[mit/] [mittlerer/normaler] priorität|priorität mittel|mit priorität mittel"),
    ("RANKED", 1): "[mit/] [niedriger/niedrigster/geringer] priorität|priorität niedrig",
    ("BY_IMPORTANCE", None): (
        "nach [wichtigkeit/priorität]|in der reihenfolge der [wichtigkeit/priorität]|"
        "[das/die/den] [wichtigste/wichtigsten] zuerst|wichtigste zuerst|wichtigstes zuerst"
    ),
    ("LEAVE_OUT", None): (
        "lass weg was nicht passt|lass weg , was nicht passt|was nicht passt entfällt|"
        "was nicht passt , entfällt|so viele wie möglich|so viele wie hineinpassen"
    ),
    ("ANY_ORDER", None): "in beliebiger reihenfolge|in einer beliebigen reihenfolge|beliebig",
    ("ORDER_FREE", None): (
        "die reihenfolge ist egal|reihenfolge ist egal|reihenfolge ist beliebig|"
        "reihenfolge spielt keine rolle|reihenfolge ist frei|auf die reihenfolge kommt es nicht an|"
        "die reihenfolge ist dir überlassen|reihenfolge ist nicht wichtig"
    ),
    ("THIS_ORDER", None): (
        "in dieser reihenfolge|genau in dieser reihenfolge|in genau dieser reihenfolge|"
        "in der angegebenen reihenfolge|in dieser genauen reihenfolge"
    ),
    ("TOTAL", None): "insgesamt|alles in allem|in summe",
    ("MODE", Mode.AUTONOMOUS): "autonom|autonomer|autonomen",
    ("MODE", Mode.SUPERVISORY): "beaufsichtigt|unter aufsicht|supervisory",
    ("UPTO", None): "bis einschließlich|bis inklusive",
    ("FINISHING", None): "nach abschluss der runde|wobei die runde beendet wird",
    ("STOPPING", None): "wobei sofort angehalten wird|mit sofortigem halt",
    ("ENDLESS", None): "endlos|ohne ende|unbegrenzt|für immer|ständig",
    ("INCLUDED", None): "unterbrechungen eingeschlossen|einschließlich unterbrechungen",
    ("EXCLUDED", None): "unterbrechungen ausgenommen|ohne unterbrechungen",
    ("IN_CIRCLES", None): "im kreis|in runden",
    ("STANDING", None): "stehend an|stehend bei",
    ("SHOWN_IN", None): "gezeigt in|zu sehen in",
    ("ABOUT", None): "zum objekt|über objekt",
    ("JOINTS", None): "mit gelenken|mit gelenk",
    ("VELOCITIES", None): "geschwindigkeiten",
    ("EFFORTS", None): "kräfte|kräften",
    ("READING", None): "ablesezeit höchstens|ablesung höchstens|lesezeit höchstens",
    ("OR_ELSE", None): "oder sonst",
    ("PREFERABLY", None): "möglichst|wenn möglich|falls möglich|vorzugsweise",
    ("ANY_TIME", None): "jederzeit|zu jeder zeit|zu beliebiger zeit",
    ("LEAVING", None): "abfahrt mit|verlassend mit",
    (
        "AGE",
        None,
    ): "gemessen innerhalb der letzten|gemessen in den letzten|nicht älter als|in den letzten",
    ("LPAR_CALLED", None): "( genannt",
    ("LPAR_BOUND", None): "( mit zweiter grenze",
    ("SECOND_BOUND", None): "mit zweiter grenze",
    ("X", None): "x",
    ("Y", None): "y",
    ("Z", None): "z",
    ("HEADING", None): "ausrichtung|blickrichtung",
    ("RAD", None): "rad",
    (
        "EARLIEST",
        None,
    ): "nicht vor|nicht früher als|frühestens nach|frühestens|nicht vor ablauf von",
    ("UNIT_S", 86400.0): "tag{e}|tagen|tages",
    ("UNIT_S", 3600.0): "h|std .|std|stunde{n}",
    ("UNIT_S", 2700.0): "dreiviertelstunde{n}|dreiviertel stunde{n}",
    ("UNIT_S", 1800.0): "halbstunde{n}",
    ("UNIT_S", 900.0): "viertelstunde{n}|viertel stunde{n}",
    ("UNIT_S", 60.0): "min|minute{n}|'",
    ("UNIT_S", 1.0): "s|sek|sekunde{n}",
    ("RATE", 1.0): "m / s|meter{n} pro sekunde|meter{n} je sekunde|meter{n} in der sekunde",
    ("RATE", 0.01): "cm / s|zentimeter{n} pro sekunde|zentimeter{n} je sekunde",
    ("RATE", 1 / 3.6): "km / h|kmh|km / std|kilometer{n} pro stunde|stundenkilometer{n}",
}

_UNITS = expand("ein|zwei|drei|vier|fünf|sechs|sieben|acht|neun")
_TEENS = expand("zehn|elf|zwölf|dreizehn|vierzehn|fünfzehn|sechzehn|siebzehn|achtzehn|neunzehn")
_TENS = expand("zwanzig|dreißig|vierzig|fünfzig|sechzig|siebzig|achtzig|neunzig")

FIGURES: Phrases = {
    **{("NUMBER_WORD", n): word for n, word in enumerate(_UNITS + _TEENS, start=1)},
    ("NUMBER_WORD", 1): "eins",
    ("NUMBER_WORD", 2): "zwei|zwo",
    ("NUMBER_WORD", 12): "zwölf|dutzend",
    **{
        ("NUMBER_WORD", n + 0.5): f"{word}einhalb|{word} einhalb"
        for n, word in enumerate(_UNITS + _TEENS, start=1)
    },
    ("NUMBER_WORD", 1.5): "eineinhalb|anderthalb|einundeinhalb",
    **{("NUMBER_WORD", 10 * n): word for n, word in enumerate(_TENS, start=2)},
    **{
        ("NUMBER_WORD", 10 * n + k): f"{unit}und{ten}"
        for n, ten in enumerate(_TENS, start=2)
        for k, unit in enumerate(_UNITS, start=1)
    },
    ("NUMBER_WORD", 100): "hundert|einhundert",
    ("NUMBER_WORD", 1000): "tausend|eintausend",
    ("UNIT", "bar"): "bar",
    ("UNIT", "mbar"): "mbar|millibar",
    ("UNIT", "psi"): "psi",
    ("UNIT", "Pa"): "pa|pascal",
    ("UNIT", "hPa"): "hpa|hektopascal",
    ("UNIT", "kPa"): "kpa|kilopascal",
    ("UNIT", "MPa"): "mpa|megapascal",
    ("UNIT", "atm"): "atm|atmosphären",
    ("UNIT", "%"): "%|prozent",
    ("UNIT", "deg"): "°|deg|grad",
    ("UNIT", "rad"): "radiant",
    ("UNIT", "degC"): "° c|grad celsius",
    ("UNIT", "degF"): "° f|grad fahrenheit",
    ("UNIT", "mm"): "mm|millimeter{n}",
    ("UNIT", "cm"): "cm|zentimeter{n}",
    ("UNIT", "m"): "m|meter{n}",
    ("UNIT", "l"): "liter{n}",
    ("UNIT", "kg"): "kg|kilogramm",
    ("HALF", None): "halbe|halben|halber|halbes|einhalb",
}

JOINTS: Phrases = {
    ("JOINT", "and"): "und|sowie",
    ("JOINT", "but"): "aber|jedoch",
    ("JOINT", "or"): "oder|beziehungsweise",
}

PARTS = (NOTHING, VERBS, NOUNS, CONDITIONS, MANNERS, FIGURES, JOINTS)

OWN: Phrases = {
    ("SHOWN", "value"): "[wert/werte/messwert/messwerte]",
    ("SHOWN", "position"): "[stellung/stellungen/position]",
    ("SHOWN", "level"): "[füllstand/füllstände/pegel]",
    ("SHOWN", "pressure"): "[druck/drücke]",
    ("BACK", None): (
        f"{_parted('zurück', _DRIVE)}|{_parted('zurück', _TURN)}|{_parted('zurück', _COME)}|"
        f"{_parted('zurück', _GO)}|zurück … fahren|zurück … kehren|zurück|rückkehr"
    ),
    ("KIND", (Kind.PRESSURE_GAUGE, None)): "manometer|druckmanometer|druckmesser|druckmessgerät",
    ("KIND", (Kind.LIQUID_LEVEL_GAUGE, None)): "füllstandsmesser|füllstandmesser",
    ("ON_FAILURE", None): "bei misserfolg|im fehlerfall|bei fehlschlag|schlägt … fehl",
    ("THEY", None): "sie",
    ("HE", None): "er",
}
"""What only German has, and what `word_order` makes of it: what a checkpoint shows, which is that
of the one behind it or of the last one; words whose plural looks the same; what means going to a
place or going home; pronouns that may be the robot's."""
