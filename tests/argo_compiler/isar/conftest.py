"""Table of the data that isar accepts, independent of Argo's models."""

NUMBER, TEXT = (int, float), str

MODELS = {
    "StartMissionDefinition": (
        {"tasks": ["StartMissionTaskDefinition"]},
        {"id": TEXT, "name": TEXT, "start_pose": "InputPose"},
    ),
    "StartMissionTaskDefinition": (
        {"pose": "InputPose"},
        {
            "id": TEXT,
            "type": {"inspection", "return_to_home"},
            "inspection": "StartMissionInspectionDefinition",
            "tag": TEXT,
            "zoom": "ZoomDescription",
        },
    ),
    "StartMissionInspectionDefinition": (
        {"inspection_target": "InputPosition"},
        {
            "type": {"Image", "ThermalImage", "Video", "ThermalVideo", "Audio", "CO2Measurement"},
            "inspection_description": TEXT,
            "duration": NUMBER,
        },
    ),
    "InputPose": (
        {"position": "InputPosition", "orientation": "InputOrientation"},
        {"frame_name": TEXT},
    ),
    "InputPosition": ({"x": NUMBER, "y": NUMBER, "z": NUMBER}, {"frame_name": TEXT}),
    "InputOrientation": (
        {"x": NUMBER, "y": NUMBER, "z": NUMBER, "w": NUMBER},
        {"frame_name": TEXT},
    ),
    "ZoomDescription": ({"objectWidth": NUMBER, "objectHeight": NUMBER}, {}),
}
"""Models of isar 1.34.28: required fields and optional fields.

They are copied from src/isar/apis/models/start_mission_definition.py and models.py of
github.com/equinor/isar.
"""


def assert_isar_accepts(value, model="StartMissionDefinition"):
    """Assert that a value matches isar's model, without further fields, which isar would ignore."""
    if isinstance(model, list):
        assert isinstance(value, list)
        for element in value:
            assert_isar_accepts(element, model[0])
    elif isinstance(model, set):
        assert value in model
    elif isinstance(model, str):
        required, optional = MODELS[model]
        assert isinstance(value, dict), model
        assert set(required) <= set(value) <= {*required, *optional}, model
        for name, part in value.items():
            assert_isar_accepts(part, (required | optional)[name])
    else:
        assert isinstance(value, model), model
        assert not isinstance(value, bool)
