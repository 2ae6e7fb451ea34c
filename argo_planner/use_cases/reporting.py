"""Report of a run, made from its record."""

import tempfile
from pathlib import Path

from argo_compiler.base.stages import stage
from argo_env.faults.kinds import site_with_faults
from argo_env.pictures import write_overview
from argo_env.report.files import PAGE, RECORD, write_report
from argo_env.robot.spec import RobotSpec
from argo_env.run.record import RunRecord
from argo_env.site import Site

REPORT_FILES = (RECORD, "site.png", PAGE)
"""names of the files; the page is the last one, since it shows the others"""


def report_files(record: RunRecord, site: Site, robot: RobotSpec) -> dict[str, bytes]:
    """Return the content of each file of a run's report, by file name.

    `site` is the site as the robot knew it; changes by faults are in the record.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with stage("writing the report"):
            write_report(record, site, folder)
        with stage("drawing the site"):
            write_overview(
                record, site_with_faults(site, record.faults), robot, folder / "site.png"
            )
        return {name: (folder / name).read_bytes() for name in REPORT_FILES}
