"""Recognition of files of other programs, so that a message can name what they are.

Nothing here is read as a mission. Only what a format itself states is trusted: its first bytes, its
root element, its own fields; a name's suffix never suffices.
"""

import io
import re
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_compiler.files.encodings import detect_encoding

_HEAD = 4096
"""number of bytes in which the formats that are texts are recognised"""
_XML_HEAD = 1_000_000
"""number of bytes in which the root element of XML is looked for, behind any comments"""
_MAX_YAML = 100_000
"""number of characters of the longest YAML whose fields are looked at, which takes seconds"""
CHOOSE = Message("choose the mission's file")
_STEPS = Message("write its steps as a script, as Argo can't import it")
_STOPS = Message("write its stops as a script, as Argo can't import it")
_UNPACK = Message("unpack it, and choose the mission in it")
_TEXT = Message("save it as plain text")
_OFFICE = Message("save it as .docx, .xlsx or plain text")
_ENCRYPTED = "EncryptedPackage".encode("utf-16-le")
"""the part of an encrypted Office document that has its content"""
_CHART = Message("choose the mission of which it was made, or write its steps as a script")


class ForeignFile(NamedTuple):
    """Kind of file of another program, and what to do instead."""

    kind: str
    """noun with its article, such as `a VDA 5050 order`"""
    way_out: str = CHOOSE

    @property
    def message(self) -> str:
        return Message("is no mission, but {kind}: {way_out}", kind=self.kind, way_out=self.way_out)


def require_no_foreign_file(name: str, content: bytes) -> None:
    """Raise Invalid if the content is a file of another program; JSON is not looked at here."""
    if found := find_foreign_file(name, content):
        raise Invalid(Message("{name} {message}", name=name, message=found.message))


def find_foreign_file(name: str, content: bytes) -> ForeignFile | None:
    """Return what a file of another program is, or None if it may be a script or JSON."""
    if found := _find_by_first_bytes(content):
        return found
    encoding = detect_encoding(content)
    if encoding is None:
        return None  # binary; the readers report that
    head = content[:_HEAD].decode(encoding, "replace").removeprefix("\ufeff")
    if head.lstrip().startswith("<"):
        text = content[:_XML_HEAD].decode(encoding, "replace").removeprefix("\ufeff")
        if root := _XML_ROOT.match(text):
            return _find_by_root(root[1], text[root.start(1) :][:_HEAD])
    for pattern, found in _TEXTS:
        if pattern.search(head):
            return found
    if Path(name).suffix.lower() in (".yaml", ".yml"):
        return _find_in_yaml(content.decode(encoding, "replace"))
    return None


# ---- binary files and archives

_OLD_OFFICE = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
_MAGIC = (
    (b"%PDF-", ForeignFile(Message("a document (PDF)"), _TEXT)),
    (rb"{\rtf", ForeignFile(Message("a document (RTF)"), _TEXT)),
    (_OLD_OFFICE, ForeignFile(Message("an old Office document"), _OFFICE)),
    (b"\x89PNG\r\n", ForeignFile(Message("a picture (PNG)"))),
    (b"\xff\xd8\xff", ForeignFile(Message("a picture (JPEG)"))),
    (b"GIF8", ForeignFile(Message("a picture (GIF)"))),
    (b"II*\0", ForeignFile(Message("a picture (TIFF)"))),
    (b"MM\0*", ForeignFile(Message("a picture (TIFF)"))),
    (b"\x1f\x8b", ForeignFile(Message("a compressed file (gzip)"), _UNPACK)),
    (b"BZh", ForeignFile(Message("a compressed file (bzip2)"), _UNPACK)),
    (b"\xfd7zXZ\0", ForeignFile(Message("a compressed file (xz)"), _UNPACK)),
    (b"\x28\xb5\x2f\xfd", ForeignFile(Message("a compressed file (Zstandard)"), _UNPACK)),
    (b"7z\xbc\xaf\x27\x1c", ForeignFile(Message("an archive (7z)"), _UNPACK)),
    (b"Rar!", ForeignFile(Message("an archive (RAR)"), _UNPACK)),
    (b"PAR1", ForeignFile(Message("a Parquet file"))),
    (b"ARROW1", ForeignFile(Message("an Arrow file"))),
    (b"\x89HDF\r\n", ForeignFile(Message("an HDF5 file"))),
    (b"\x93NUMPY", ForeignFile(Message("a NumPy array"))),
    (b"glTF", ForeignFile(Message("a mesh (glTF)"))),
    (b"\x7fELF", ForeignFile(Message("a program (ELF)"))),
    (b"MZ\x90\0", ForeignFile(Message("a program of Windows"))),
)
_PICKLE = re.compile(rb"\x80[\x02-\x05].*\.\Z", re.DOTALL)
_TAR = slice(257, 262)
_SQLITE = b"SQLite format 3\0"
_BAG_TABLE = b"CREATE TABLE topics"
"""table of each rosbag2 that is an SQLite database"""
_PARTS_OF_ZIP = (
    ("word/document.xml", ForeignFile(Message("a Word document"), _TEXT)),
    (
        "xl/workbook.xml",
        ForeignFile(Message("an Excel spreadsheet"), Message("save its cells as plain text")),
    ),
    ("ppt/presentation.xml", ForeignFile(Message("a PowerPoint presentation"), _TEXT)),
    ("modelDescription.xml", ForeignFile(Message("an FMU (FMI)"))),
    ("doc.kml", ForeignFile(Message("places and ways of a map (KMZ)"), _STOPS)),
    ("wpmz/template.kml", ForeignFile(Message("a flight of a drone (KMZ)"), _STOPS)),
)


def _find_by_first_bytes(content: bytes) -> ForeignFile | None:
    start = content[:_HEAD].lstrip(b" \t\r\n")[:16]
    if content.startswith(_OLD_OFFICE) and _ENCRYPTED in content:
        return ForeignFile(
            Message("an encrypted Office document"), Message("save it without a password")
        )
    for magic, found in _MAGIC:
        if content.startswith(magic) or (found.way_out == _TEXT and start.startswith(magic)):
            return found
    if content.startswith(b"PK\x03\x04"):
        return _find_in_zip(content)
    if content[_TAR] == b"ustar":
        return ForeignFile(Message("an archive (tar)"), _UNPACK)
    if content.startswith(_SQLITE) and _BAG_TABLE not in content[: 1 << 16]:
        return ForeignFile(Message("an SQLite database, and no bag of ROS 2"))
    if _PICKLE.match(content):
        return ForeignFile(Message("a pickled Python object"))
    return None


def _find_in_zip(content: bytes) -> ForeignFile:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            names = set(archive.namelist())
    except (zipfile.BadZipFile, ValueError, OSError, NotImplementedError):
        return ForeignFile(Message("a damaged ZIP archive"))
    for part, found in _PARTS_OF_ZIP:
        if part in names:
            return found
    if {"mimetype", "content.xml"} <= names:
        return ForeignFile(Message("an OpenDocument file"), _OFFICE)
    return ForeignFile(Message("a ZIP archive"), _UNPACK)


# ---- XML

_XML_ROOT = re.compile(
    r"\s*(?>(?><\?[^>]*>|<!--.*?-->|<!(?!doctype\s+html)[a-z][^>\[]*(?:\[[^\]]*\]\s*)?>)\s*)*+"
    r"<(!doctype\s+html|[a-z_][\w.:-]*)",
    re.IGNORECASE | re.DOTALL,
)
_WEB_PAGE = ForeignFile(Message("a web page (HTML)"))
_ROOTS = {
    "launch": ForeignFile(Message("a launch file of ROS")),
    "robot": ForeignFile(Message("a model of a robot (URDF)")),
    "sdf": ForeignFile(Message("a simulated world or model (SDF)")),
    "mujoco": ForeignFile(Message("a simulated model (MuJoCo)")),
    "package": ForeignFile(Message("the description of a ROS package")),
    "kml": ForeignFile(Message("places and ways of a map (KML)"), _STOPS),
    "gpx": ForeignFile(Message("tracks and waypoints (GPX)"), _STOPS),
    "scxml": ForeignFile(Message("a state chart (SCXML)"), _CHART),
    "opendrive": ForeignFile(Message("a map of roads (OpenDRIVE)")),
    "openscenario": ForeignFile(Message("a traffic scenario (OpenSCENARIO)")),
    "fmimodeldescription": ForeignFile(Message("the description of an FMU (FMI)")),
    "collada": ForeignFile(Message("a mesh (COLLADA)")),
    "svg": ForeignFile(Message("a picture (SVG)")),
    "html": _WEB_PAGE,
    "body": _WEB_PAGE,
    "osm": ForeignFile(Message("a map (OpenStreetMap)")),
    "ifcxml": ForeignFile(Message("a model of a building (IFC)")),
    "treenodesmodel": ForeignFile(Message("a list of nodes of BehaviorTree.CPP"), _CHART),
}


def _find_by_root(name: str, head: str) -> ForeignFile:
    local = name.lower().rpartition(":")[2]
    if local.startswith("!doctype"):
        return _WEB_PAGE
    if "<BehaviorTree" in head or "BTCPP_format" in head or "main_tree_to_execute" in head:
        return ForeignFile(Message("a behaviour tree of BehaviorTree.CPP"), _CHART)
    return _ROOTS.get(local, ForeignFile(Message("XML, with <{name}>", name=name[:40])))


# ---- plain text

_BLANK = r"(?>[ \t]*(?:[#;].*)?\r?\n)*+"
"""empty lines and comments"""
_TEXTS = (
    (
        re.compile(r"\AQGC WPL \d+"),
        ForeignFile(
            Message("a list of MAVLink waypoints (QGroundControl, Mission Planner)"), _STOPS
        ),
    ),
    (re.compile(r"\ABEGIN:VCALENDAR\b"), ForeignFile(Message("a calendar (iCalendar)"), _STEPS)),
    (re.compile(r"\ABEGIN:VCARD\b"), ForeignFile(Message("a contact (vCard)"))),
    (
        re.compile(r"\AISO-10303-21;.*FILE_SCHEMA\s*\(\s*\(\s*'IFC", re.DOTALL),
        ForeignFile(Message("a model of a building (IFC)")),
    ),
    (re.compile(r"\AISO-10303-21;"), ForeignFile(Message("a CAD model (STEP)"))),
    (
        re.compile(rf"\A{_BLANK}[ \t]*\(define\s*\("),
        ForeignFile(Message("a planning problem (PDDL)")),
    ),
    (
        re.compile(
            rf"\A{_BLANK}(?:[ \t]*(?:[\d.]+[ \t]*:[ \t]*)?\([a-z][\w-]*(?:[ \t]+[a-z][\w-]*)*\)"
            rf"[ \t]*(?:\[[\d.]+\])?[ \t]*\r?\n)+{_BLANK}\Z",
            re.IGNORECASE,
        ),
        ForeignFile(Message("a plan of a PDDL planner"), _STEPS),
    ),
    (
        re.compile(r"\A\s*0\r?\n\s*SECTION\r?\n\s*2\r?\n"),
        ForeignFile(Message("a CAD drawing (DXF)")),
    ),
    (
        re.compile(r"\A(?>\s+|(?://|#).*\n)*+(?:strict\s+)?(?:di)?graph\b[^{\n]*\{"),
        ForeignFile(Message("a graph (Graphviz)"), _CHART),
    ),
    (
        re.compile(
            r"\A(?>\s+|%%.*\n)*+"
            r"(?:stateDiagram(?:-v2)?|(?:flowchart|graph)[ \t]+(?:T[BD]|BT|RL|LR))"
            r"[ \t]*;?[ \t]*\r?\n"
        ),
        ForeignFile(Message("a diagram (Mermaid)"), _CHART),
    ),
    (
        re.compile(
            rf"\A{_BLANK}[ \t]*def \w+\(.*\):[ \t]*\r?\n(?:.*\n)*?[ \t]*end[ \t]*\r?(?:\n|\Z)"
        ),
        ForeignFile(Message("a program of a robot arm (URScript)"), _STEPS),
    ),
    (re.compile(r"\A[$!][A-Z]{5},"), ForeignFile(Message("a track of positions (NMEA)"))),
    (re.compile(r"\A# \.PCD "), ForeignFile(Message("a point cloud (PCD)"))),
    (re.compile(r"\Aply\r?\nformat "), ForeignFile(Message("a mesh or point cloud (PLY)"))),
    (re.compile(r"\Asolid\b.*\n\s*facet normal "), ForeignFile(Message("a mesh (STL)"))),
    (
        re.compile(r"^(?:from [\w.]+ import \w|def \w+\(.*:[ \t]*\r?$)|\A#!.*python", re.M),
        ForeignFile(Message("a Python program")),
    ),
    (
        re.compile(
            rf"\A(?>{_BLANK}[\w.-]+[ \t]*=.*\n)*+{_BLANK}\[\[?[\w.\" -]+\]\]?[ \t]*\r?\n"
            rf"{_BLANK}[\w.\"-]+[ \t]*="
        ),
        ForeignFile(Message("a file of settings (TOML or INI)")),
    ),
)


# ---- YAML

_SITES = Message("YAML, in which sites, faults and evaluations are written")


def _find_in_yaml(text: str) -> ForeignFile:
    from argo_compiler.files.yaml_text import load_yaml  # importing it takes long

    try:
        data = load_yaml(text, "") if len(text) <= _MAX_YAML else None
    except Invalid:
        data = None
    return find_foreign_yaml(data) or ForeignFile(_SITES)


def find_foreign_yaml(data: Any) -> ForeignFile | None:
    """Return what the data of a YAML file of another program are, or None if they are not known."""
    for item in data if isinstance(data, list) else [data]:
        if isinstance(item, Mapping) and _is_waypoint(item):
            return ForeignFile(Message("a list of waypoints, as Nav2 follows them"), _STOPS)
    fields = data if isinstance(data, Mapping) else {}
    return next((found for is_kind, found in _YAMLS if is_kind(fields)), None)


def _is_waypoint(fields: Mapping[Any, Any]) -> bool:
    return bool({"waypoints", "poses"} & fields.keys()) or (
        "pose" in fields and bool({"header", "orientation"} & fields.keys())
    )


def _has(*names: str) -> Callable[[Mapping[Any, Any]], bool]:
    return lambda fields: set(names) <= fields.keys()


def _has_ros_parameters(fields: Mapping[Any, Any]) -> bool:
    """Return True if a node in any namespace has parameters."""
    pending: list[Any] = [*fields.values()]
    for value in pending:  # grows
        if isinstance(value, Mapping):
            if "ros__parameters" in value:
                return True
            if len(pending) < 10_000:
                pending += value.values()
    return False


_OPENAPI = ForeignFile(Message("the description of a web service (OpenAPI)"))
_YAMLS = (
    (_has_ros_parameters, ForeignFile(Message("parameters of ROS nodes"))),
    (_has("image", "resolution", "origin"), ForeignFile(Message("a map of ROS"))),
    (
        _has("rosbag2_bagfile_information"),
        ForeignFile(Message("the metadata of a bag"), Message("choose the bag's folder")),
    ),
    (_has("openapi"), _OPENAPI),
    (_has("swagger"), _OPENAPI),
    (_has("apiVersion", "kind"), ForeignFile(Message("a resource of Kubernetes"))),
    (_has("jobs", "on"), ForeignFile(Message("a workflow of a CI service"))),
    (_has("services"), ForeignFile(Message("a list of containers (Compose)"))),
)


# ---- JSON

_ISAR_1_34 = Message("write it again in the format of isar 1.34")
_GEOJSON = ForeignFile(Message("places of a map (GeoJSON)"), _STOPS)


def find_foreign_json(data: Any) -> ForeignFile | None:
    """Return what the JSON of another program is, or None if it is not known.

    A list is what its first item is.
    """
    if isinstance(data, list) and data and isinstance(data[0], Mapping):
        found = find_foreign_json(data[0])
        return found and ForeignFile(
            Message("a list, beginning with {kind}", kind=found.kind), found.way_out
        )
    if not isinstance(data, Mapping):
        return None
    if {"headerId", "manufacturer", "serialNumber"} <= data.keys() or _has(
        "orderId", "nodes", "edges"
    )(data):
        return _vda5050(data)
    if isar := _find_isar(data):
        return isar
    return next((found for is_kind, found in _JSONS if is_kind(data)), None)


def _vda5050(data: Mapping[str, Any]) -> ForeignFile:
    if {"orderId", "nodes"} <= data.keys():
        return ForeignFile(Message("a VDA 5050 order"), _STOPS)
    for field, kind in (
        ("actions", Message("VDA 5050 instant actions")),
        ("nodeStates", Message("a VDA 5050 state")),
        ("connectionState", Message("a VDA 5050 connection")),
        ("agvPosition", Message("a VDA 5050 visualization")),
        ("typeSpecification", Message("a VDA 5050 factsheet")),
    ):
        if field in data:
            return ForeignFile(kind)
    return ForeignFile(Message("a VDA 5050 message"))


def _find_isar(data: Mapping[str, Any]) -> ForeignFile | None:
    """Return an isar mission in a format that Argo does not read, by its first task."""
    if isinstance(data.get("mission_steps"), list):
        return ForeignFile(Message("an isar mission of an older format"), _ISAR_1_34)
    definition = data.get("mission_definition", data)
    tasks = definition.get("tasks") if isinstance(definition, Mapping) else None
    first = tasks[0] if isinstance(tasks, list) and tasks else None
    if not isinstance(first, Mapping) or "action" in first:
        return None
    if isinstance(first.get("steps"), list) or isinstance(first.get("inspections"), list):
        return ForeignFile(Message("an isar mission of an older format"), _ISAR_1_34)
    if "robot_pose" in first or "inspection" in first or "inspection_target" in first:
        return ForeignFile(Message("an isar mission of another format"), _ISAR_1_34)
    return None


def _is_geojson(data: Mapping[str, Any]) -> bool:
    return data.get("type") in {
        "FeatureCollection", "Feature", "Point", "MultiPoint", "LineString", "MultiLineString",
        "Polygon", "MultiPolygon", "GeometryCollection",
    } and bool({"features", "geometry", "coordinates", "geometries"} & data.keys())  # fmt: skip


_JSONS = (
    (_has("fileType", "groundStation"), ForeignFile(Message("a plan of QGroundControl"), _STOPS)),
    (
        _has("items", "plannedHomePosition"),
        ForeignFile(Message("mission items of QGroundControl"), _STOPS),
    ),
    (_has("mission_items"), ForeignFile(Message("a mission of MAVSDK"), _STOPS)),
    (_has("category", "description"), ForeignFile(Message("a task of Open-RMF"), _STOPS)),
    (_is_geojson, _GEOJSON),
    (_has("openapi"), _OPENAPI),
    (_has("swagger"), _OPENAPI),
    (
        lambda data: "json-schema.org" in str(data.get("$schema"))[:100],
        ForeignFile(Message("a JSON Schema")),
    ),
    (_has("nbformat", "cells"), ForeignFile(Message("a Jupyter notebook"))),
    (
        lambda data: (
            {"name", "version"} <= data.keys()
            and bool({"dependencies", "devDependencies", "scripts", "main"} & data.keys())
        ),
        ForeignFile(Message("the description of a package of Node.js")),
    ),
    (_has("asset", "scenes"), ForeignFile(Message("a mesh (glTF)"))),
)
