"""Module whose import prepares the process that those of a service under test are forked from.

Without it the processes behave alike but take longer: each loads modules late and computes paths.
"""

from argo_env.planning import open_site
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_planner.use_cases.reporting import report_files
from tests.forking import draw_small_overviews, load_late_modules
from tests.whole_scripts import import_whole

SCRIPT = (
    "Mission Protocol #1\n1. Set the starting point in starting area 1.\n2. Check valve R18.\n"
    "3. Check valve R25.\n4. Return to the docking station in starting area 1.\n"
)

draw_small_overviews()  # these tests do not check it
load_late_modules()
_site = open_site("umad").prepare()
_mission = import_whole(SCRIPT, _site.catalog).mission
_spec = RunSpec(mission=_mission, site=_site.reference, drive="route")
report_files(simulate(_spec, _site), _site.site, _site.robot)
