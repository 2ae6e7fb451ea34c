"""Small files of other programs, each as its format's own documentation has them.

They are no missions: a user gives one by mistake, or hopes that Argo reads it.
"""

import io
import json
import pickle
import sqlite3
import struct
import zipfile
import zlib
from collections.abc import Mapping
from contextlib import closing
from typing import NamedTuple

import pyarrow as pa
import pyarrow.parquet as pq


class ForeignFile(NamedTuple):
    """File of another program, and what the message about it must name."""

    name: str
    content: bytes
    named: str


def _json(data: object) -> bytes:
    return json.dumps(data, indent=2).encode()


def _zip(files: Mapping[str, str]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return buffer.getvalue()


def _parquet() -> bytes:
    buffer = io.BytesIO()
    pq.write_table(pa.table({"checkpoint": [1, 8], "value": [4.2, 1.0]}), buffer)
    return buffer.getvalue()


def _sqlite() -> bytes:
    with closing(sqlite3.connect(":memory:")) as database:
        database.execute("CREATE TABLE checkpoints (id INTEGER, name TEXT)")
        return database.serialize()


def _png() -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    header = struct.pack(">IIBBBBB", 1, 1, 8, 0, 0, 0, 0)
    pixels = zlib.compress(b"\0\0")
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")
    )


_VDA5050 = {
    "headerId": 1,
    "timestamp": "2026-11-27T10:00:00.00Z",
    "version": "2.0.0",
    "manufacturer": "Robots",
    "serialNumber": "R1",
}
_ORDER = _VDA5050 | {
    "orderId": "round-7",
    "orderUpdateId": 0,
    "nodes": [
        {
            "nodeId": "n1",
            "sequenceId": 0,
            "released": True,
            "nodePosition": {"x": 1.0, "y": 2.0, "theta": 0.0, "mapId": "hall"},
            "actions": [],
        }
    ],
    "edges": [],
}
_STATE = _VDA5050 | {
    "orderId": "round-7",
    "orderUpdateId": 0,
    "lastNodeId": "n1",
    "lastNodeSequenceId": 0,
    "nodeStates": [],
    "edgeStates": [],
    "driving": False,
    "actionStates": [],
    "batteryState": {"batteryCharge": 80.0, "charging": False},
    "operatingMode": "AUTOMATIC",
    "errors": [],
    "safetyState": {"eStop": "NONE", "fieldViolation": False},
}
_INSTANT = _VDA5050 | {
    "actions": [{"actionId": "a1", "actionType": "cancelOrder", "blockingType": "HARD"}]
}
_ITEM = {
    "AMSLAltAboveTerrain": None,
    "Altitude": 50,
    "autoContinue": True,
    "command": 16,
    "doJumpId": 1,
    "frame": 3,
    "params": [0, 0, 0, None, 47.39, 8.54, 50],
    "type": "SimpleItem",
}
_PLAN = {
    "fileType": "Plan",
    "geoFence": {"circles": [], "polygons": [], "version": 2},
    "groundStation": "QGroundControl",
    "mission": {
        "cruiseSpeed": 15,
        "firmwareType": 12,
        "items": [_ITEM],
        "plannedHomePosition": [47.39, 8.54, 488],
        "vehicleType": 2,
        "version": 2,
    },
    "rallyPoints": {"points": [], "version": 2},
    "version": 1,
}
_POSE = {
    "position": {"x": 1.0, "y": 2.0, "z": 0.0, "frame_name": "asset"},
    "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0, "frame_name": "asset"},
    "frame_name": "asset",
}
_ISAR_OLDER = {
    "tasks": [
        {
            "steps": [
                {"type": "drive_to_pose", "pose": _POSE},
                {"type": "take_image", "target": {"x": 1.0, "y": 3.0, "z": 1.0, "frame": "asset"}},
            ]
        }
    ]
}
_ISAR_OLDEST = {
    "id": "2",
    "tasks": [
        {
            "pose": _POSE,
            "tag": "1",
            "inspections": [{"type": "Image", "inspection_target": _POSE["position"]}],
        }
    ],
}
_ISAR_NEWER = {
    "name": "round",
    "tasks": [
        {
            "type": "take_image",
            "robot_pose": _POSE,
            "target": _POSE["position"],
            "tag_id": "1",
        }
    ],
}
_BT3 = """<?xml version="1.0"?>
<root main_tree_to_execute="MainTree">
  <BehaviorTree ID="MainTree">
    <Sequence name="root"><MoveBase goal="1;2;0"/></Sequence>
  </BehaviorTree>
</root>
"""
_BT4 = """<root BTCPP_format="4">
  <BehaviorTree ID="MainTree">
    <Sequence><NavigateToPose goal="{goal}"/></Sequence>
  </BehaviorTree>
</root>
"""
_WAYPOINTS = """waypoints:
  waypoint0:
    pose: [8.0, 0.0]
    orientation: [0.0, 0.0, 0.0, 1.0]
  waypoint1:
    pose: [9.0, 1.0]
    orientation: [0.0, 0.0, 0.0, 1.0]
"""
_WAYPOINT_POSES = """- header: {frame_id: map}
  pose:
    position: {x: 1.0, y: 2.0, z: 0.0}
    orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}
"""
_NAV2 = """bt_navigator:
  ros__parameters:
    use_sim_time: True
    global_frame: map
controller_server:
  ros__parameters:
    controller_frequency: 20.0
"""
_MAP = """image: hall.pgm
resolution: 0.05
origin: [-10.0, -10.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.25
"""
_ROS_LAUNCH = """<launch>
  <arg name="robot" default="r1"/>
  <node pkg="nav2_bringup" exec="bringup" name="nav"/>
</launch>
"""
_ROS_LAUNCH_PY = """from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([Node(package="nav2_bringup", executable="bringup")])
"""
_PDDL_PLAN = """0.000: (navigate r1 dock c1) [5.000]
5.001: (measure r1 c1) [2.000]
7.002: (navigate r1 c1 dock) [5.000]
; cost = 3 (unit cost)
"""
_PDDL = """(define (problem round)
  (:domain inspection)
  (:objects r1 - robot c1 c2 - checkpoint)
  (:init (at r1 c1))
  (:goal (and (read c1) (read c2))))
"""
_SCXML = """<?xml version="1.0" encoding="UTF-8"?>
<scxml xmlns="http://www.w3.org/2005/07/scxml" version="1.0" initial="a">
  <state id="a"><transition event="done" target="b"/></state>
  <final id="b"/>
</scxml>
"""
_IFC = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('ViewDefinition [CoordinationView]'),'2;1');
FILE_SCHEMA(('IFC4'));
ENDSEC;
DATA;
#1=IFCPROJECT('2O2Fr$t4X7Zf8NOew3FLOH',$,'Plant',$,$,$,$,$,$);
ENDSEC;
END-ISO-10303-21;
"""
_CHECKPOINTS = """id,name,x,y,z,yaw
1,gauge R1,1.0,2.0,1.2,0.0
8,valve R25,4.0,2.5,1.0,1.57
"""
_ICS = """BEGIN:VCALENDAR
VERSION:2.0
BEGIN:VEVENT
DTSTART:20261127T100000Z
SUMMARY:Inspection round
END:VEVENT
END:VCALENDAR
"""
_NMEA = """$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47
$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A
"""
_XACRO = """<?xml version="1.0"?>
<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r1">
  <xacro:property name="width" value="0.4"/>
</robot>
"""
_MAVLINK = (
    "QGC WPL 110\n"
    "0\t1\t0\t16\t0\t0\t0\t0\t47.39\t8.54\t488\t1\n"
    "1\t0\t3\t22\t15\t0\t0\t0\t47.39\t8.54\t50\t1\n"
)
_OFFICE = {"[Content_Types].xml": "<Types/>"}
_OPENDOCUMENT = {"mimetype": "application/vnd.oasis.opendocument.text", "content.xml": "<x/>"}

FOREIGN = [
    ForeignFile("order.json", _json(_ORDER), "a VDA 5050 order"),
    ForeignFile("state.json", _json(_STATE), "a VDA 5050 state"),
    ForeignFile("instant.json", _json(_INSTANT), "VDA 5050 instant actions"),
    ForeignFile("survey.plan", _json(_PLAN), "a plan of QGroundControl"),
    ForeignFile("survey.json", _json(_PLAN), "a plan of QGroundControl"),
    ForeignFile("items.json", _json(_PLAN["mission"]), "mission items of QGroundControl"),
    ForeignFile("survey.waypoints", _MAVLINK.encode(), "a list of MAVLink waypoints"),
    ForeignFile("survey.txt", _MAVLINK.encode(), "a list of MAVLink waypoints"),
    ForeignFile("waypoints.yaml", _WAYPOINTS.encode(), "a list of waypoints"),
    ForeignFile("poses.yaml", _WAYPOINT_POSES.encode(), "a list of waypoints"),
    ForeignFile("nav2_params.yaml", _NAV2.encode(), "parameters of ROS nodes"),
    ForeignFile("map.yaml", _MAP.encode(), "a map of ROS"),
    ForeignFile("tree3.xml", _BT3.encode(), "a behaviour tree of BehaviorTree.CPP"),
    ForeignFile("tree4.xml", _BT4.encode(), "a behaviour tree of BehaviorTree.CPP"),
    ForeignFile("orders.json", _json([_ORDER, _ORDER]), "a VDA 5050 order"),
    ForeignFile("places.json", _json([{"type": "Point", "coordinates": [8, 47]}]), "GeoJSON"),
    ForeignFile(
        "steps.json",
        _json({"mission_steps": [{"type": "drive_to_pose", "pose": {}}]}),
        "an isar mission of an older format",
    ),
    ForeignFile(
        "licensed.xml",
        f"<!-- {'all rights reserved ' * 4000} -->\n{_BT4}".encode(),
        "a behaviour tree of BehaviorTree.CPP",
    ),
    ForeignFile("plan.dxf", b"  0\nSECTION\n  2\nHEADER\n  9\n$ACADVER\n  1\nAC1015\n", "DXF"),
    ForeignFile("plan.dot", b"// a plan\ndigraph plan {\n  a -> b;\n}\n", "a graph (Graphviz)"),
    ForeignFile("plan.gv", b"strict graph {\n  a -- b\n}\n", "a graph (Graphviz)"),
    ForeignFile("states.mmd", b"stateDiagram-v2\n  [*] --> A\n", "a diagram (Mermaid)"),
    ForeignFile("flow.mmd", b"%% a plan\ngraph TD;\n  A --> B;\n", "a diagram (Mermaid)"),
    ForeignFile("arm.script", b"def prog():\n  movej([0, 0, 0])\nend\n", "URScript"),
    ForeignFile("blank.pdf", b"\r\n\n%PDF-1.4\n1 0 obj\n<<>>\nendobj\n", "a document (PDF)"),
    ForeignFile("older.json", _json(_ISAR_OLDER), "an isar mission of an older format"),
    ForeignFile("oldest.json", _json(_ISAR_OLDEST), "an isar mission of an older format"),
    ForeignFile("newer.json", _json(_ISAR_NEWER), "an isar mission of another format"),
    ForeignFile("bringup.launch", _ROS_LAUNCH.encode(), "a launch file of ROS"),
    ForeignFile("bringup.launch.xml", _ROS_LAUNCH.encode(), "a launch file of ROS"),
    ForeignFile("bringup.launch.py", _ROS_LAUNCH_PY.encode(), "a Python program"),
    ForeignFile(
        "robot.urdf", b'<robot name="r1"><link name="base"/></robot>\n', "a model of a robot (URDF)"
    ),
    ForeignFile("robot.urdf.xacro", _XACRO.encode(), "a model of a robot (URDF)"),
    ForeignFile(
        "world.sdf",
        b'<?xml version="1.0"?>\n<sdf version="1.9"><world name="w"/></sdf>',
        "a simulated world or model (SDF)",
    ),
    ForeignFile(
        "package.xml",
        b'<package format="3"><name>nav</name></package>',
        "the description of a ROS package",
    ),
    ForeignFile("site.geojson", _json({"type": "FeatureCollection", "features": []}), "GeoJSON"),
    ForeignFile("site.json", _json({"type": "FeatureCollection", "features": []}), "GeoJSON"),
    ForeignFile(
        "way.kml", b'<?xml version="1.0"?><kml xmlns="http://www.opengis.net/kml/2.2"/>', "KML"
    ),
    ForeignFile(
        "way.gpx", b'<?xml version="1.0"?><gpx version="1.1" creator="x"><wpt/></gpx>', "GPX"
    ),
    ForeignFile("checkpoints.csv", _CHECKPOINTS.encode(), "a table (CSV)"),
    ForeignFile(
        "openapi.json",
        _json({"openapi": "3.1.0", "info": {}, "paths": {}}),
        "the description of a web service (OpenAPI)",
    ),
    ForeignFile(
        "openapi.yaml",
        b"openapi: 3.1.0\ninfo: {title: x}\npaths: {}\n",
        "the description of a web service (OpenAPI)",
    ),
    ForeignFile(
        "package.json",
        _json({"name": "x", "version": "1.0.0", "dependencies": {}}),
        "the description of a package of Node.js",
    ),
    ForeignFile(
        "round.ipynb",
        _json({"cells": [], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}),
        "a Jupyter notebook",
    ),
    ForeignFile("round.ics", _ICS.encode(), "a calendar"),
    ForeignFile("sheet.pdf", b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n1 0 obj\n", "PDF"),
    ForeignFile("sheet.txt", b"%PDF-1.7\n1 0 obj\n", "PDF"),
    ForeignFile("sheet.rtf", rb"{\rtf1\ansi Mission}", "RTF"),
    ForeignFile("plan.png", _png(), "a picture"),
    ForeignFile("plan.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF\0\1", "a picture"),
    ForeignFile("sheet.docx", _zip(_OFFICE | {"word/document.xml": "<x/>"}), "a Word document"),
    ForeignFile("sheet.xlsx", _zip(_OFFICE | {"xl/workbook.xml": "<x/>"}), "an Excel spreadsheet"),
    ForeignFile(
        "sheet.xls", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(504), "an old Office document"
    ),
    ForeignFile("sheet.odt", _zip(_OPENDOCUMENT), "an OpenDocument file"),
    ForeignFile("missions.zip", _zip({"mission.txt": "Check 1."}), "a ZIP archive"),
    ForeignFile("missions.gz", b"\x1f\x8b\x08\0\0\0\0\0\0\3", "a compressed file"),
    ForeignFile(
        "missions.tar",
        b"mission.txt".ljust(257, b"\0") + b"ustar\0" + b"00" + bytes(247),
        "an archive",
    ),
    ForeignFile("page.html", b"<!DOCTYPE html>\n<html><body>Mission</body></html>", "a web page"),
    ForeignFile("page.txt", b"<html><head></head></html>", "a web page"),
    ForeignFile(
        "pyproject.toml",
        b'[project]\nname = "x"\nversion = "1"\n',
        "a file of settings (TOML or INI)",
    ),
    ForeignFile(
        "robot.ini", b"[robot]\nname = r1\nspeed = 0.5\n", "a file of settings (TOML or INI)"
    ),
    ForeignFile("chart.scxml", _SCXML.encode(), "SCXML"),
    ForeignFile("chart.xml", _SCXML.encode(), "SCXML"),
    ForeignFile("round.plan", _PDDL_PLAN.encode(), "a plan of a PDDL planner"),
    ForeignFile("plan.txt", _PDDL_PLAN.encode(), "a plan of a PDDL planner"),
    ForeignFile("problem.pddl", _PDDL.encode(), "a planning problem (PDDL)"),
    ForeignFile(
        "schema.json",
        _json({"$schema": "https://json-schema.org/draft/2020-12/schema", "type": "object"}),
        "a JSON Schema",
    ),
    ForeignFile("rows.parquet", _parquet(), "a Parquet file"),
    ForeignFile("mission.pkl", pickle.dumps({"tasks": [1]}), "a pickled Python object"),
    ForeignFile("site.sqlite", _sqlite(), "an SQLite database"),
    ForeignFile("road.xodr", b'<?xml version="1.0"?><OpenDRIVE><header/></OpenDRIVE>', "OpenDRIVE"),
    ForeignFile(
        "drive.xosc",
        b'<?xml version="1.0"?><OpenSCENARIO><FileHeader/></OpenSCENARIO>',
        "OpenSCENARIO",
    ),
    ForeignFile("plant.ifc", _IFC.encode(), "IFC"),
    ForeignFile("robot.fmu", _zip({"modelDescription.xml": "<fmiModelDescription/>"}), "an FMU"),
    ForeignFile(
        "modelDescription.xml",
        b'<?xml version="1.0"?><fmiModelDescription fmiVersion="3.0"/>',
        "the description of an FMU",
    ),
    ForeignFile("track.nmea", _NMEA.encode(), "NMEA"),
    ForeignFile("plant.svg", b'<svg xmlns="http://www.w3.org/2000/svg"/>', "a picture"),
    ForeignFile("record.xml", b'<?xml version="1.0"?><mine><item/></mine>', "XML"),
    ForeignFile(
        "settings.json", _json({"editor.fontSize": 12, "files.exclude": {}}), "'editor.fontSize'"
    ),
    ForeignFile("list.json", b"[1, 2, 3]", "not an object"),
    ForeignFile("mission.step", b"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AP203'));\n", "STEP"),
    ForeignFile(
        "scan.pcd", b"# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n", "a point cloud"
    ),
    ForeignFile("scan.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n", "a mesh"),
    ForeignFile("part.stl", b"solid part\nfacet normal 0 0 1\nendsolid\n", "a mesh"),
    ForeignFile("program", b"\x7fELF\x02\x01\x01" + bytes(60), "a program"),
    ForeignFile(
        "mission.docx.json", _zip(_OFFICE | {"word/document.xml": "<x/>"}), "a Word document"
    ),
]
