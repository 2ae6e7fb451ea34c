"""Report of a run, made from its record."""

import tempfile
from pathlib import Path

from argo_compiler.base.stages import stage
from argo_env.faults.kinds import site_with_faults
from argo_env.pictures import write_overview
from argo_env.pictures.path_plan import write_path_plan
from argo_env.report.files import PAGE, RECORD, write_report
from argo_env.robot.spec import RobotSpec
from argo_env.run.record import RunRecord
from argo_env.site import Site
from argo_env.world.pybullet_client import has_pybullet

REPORT_FILES = (RECORD, "site.png", PAGE)
"""names of the files; the page is the last one, since it shows the others"""


def report_files(record: RunRecord, site: Site, robot: RobotSpec) -> dict[str, bytes]:
    """Return the content of each file of a run's report, by file name.

    `site` is the site as the robot knew it; changes by faults are in the record. The picture shows
    the whole site, or without PyBullet the plans of its floors.
    """
    write_picture = write_overview if has_pybullet() else write_path_plan
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with stage("writing the report"):
            write_report(record, site, folder)
        with stage("drawing the site"):
            write_picture(record, site_with_faults(site, record.faults), robot, folder / "site.png")
        return {name: (folder / name).read_bytes() for name in REPORT_FILES}
