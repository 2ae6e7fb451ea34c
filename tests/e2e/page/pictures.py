"""Pictures of `docs/planner.md`, made from the real page.

`python -m tests.e2e.page.pictures docs/images` writes them.
"""

import re
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import expect

from argo_env.planning.opening import open_site
from tests.argo_planner.service.served import ALL, Served, served
from tests.e2e.page.person import Browsers, Person

SCRIPT = Path(__file__).parents[3] / "scenarios" / "umad" / "missions" / "protocol_3.txt"


def import_mission(service: Served) -> str:
    """Import the mission of the pictures and return its id."""
    return service.imported(SCRIPT.read_text(encoding="utf-8"), filename=SCRIPT.name)


def open_mission(browsers: Browsers, service: Served, id: str, **context: Any) -> Person:
    person = browsers.person(f"http://{service.address}/?token={ALL}", "Ann", **context)
    person.open(f"/missions/{id}")
    return person


def wait_for_analysis(person: Person) -> None:
    """Wait until paths and the results of the analysis are drawn."""
    expect(person.page.locator("argo-strip")).to_contain_text("Time")
    person.page.wait_for_timeout(1500)
    person.wait_for_scene()


def take_picture(person: Person, folder: Path, name: str) -> None:
    path = folder / f"planner-{name}.png"
    person.page.screenshot(path=path)
    with Image.open(path) as picture:
        quantized = picture.convert("RGB").quantize(256, dither=Image.Dither.NONE)
    quantized.save(path, optimize=True)
    print(path)


def picture_home(browsers: Browsers, service: Served, folder: Path) -> None:
    """Picture the list of missions, with folders and runs; the service has no other missions."""
    names = ("Morning round", "Valves", "Stairs", "Night round")
    examples = ("protocol_3", "ground", "upstairs", "any_order")
    for name, example in zip(names, examples, strict=True):
        made = service.post(f"/api/examples/{example}/mission", name=name).json()
        where = "Daily" if "round" in name else "Weekly"
        service.client.put(f"/api/missions/{made['id']}/folder", json={"folder": where})
        wait_for_bounds(service, made["id"])
        if name != "Stairs":
            run = service.run(made["id"], drive="route", speed=None).json()["id"]
            while service.client.get(f"/api/runs/{run}").json()["status"] != "ended":
                time.sleep(0.1)
    ann = browsers.person(f"http://{service.address}/?token={ALL}", "Ann")
    ann.open()
    expect(ann.page.get_by_role("img")).to_be_visible()
    ann.page.locator("argo-missions tbody tr", has_text="Morning round").hover()
    expect(ann.page.locator("argo-site-picture circle.lit")).not_to_have_count(0)
    take_picture(ann, folder, "home")
    browsers.close_windows()
    for one in service.client.get("/api/missions").json()["missions"]:
        service.client.delete(f"/api/missions/{one['id']}")


def wait_for_bounds(service: Served, id: str) -> None:
    """Wait until the bounds of a mission's duration are known."""
    while True:
        missions = service.client.get("/api/missions").json()["missions"]
        if next(one for one in missions if one["id"] == id)["least_time"] is not None:
            return
        time.sleep(0.1)


def picture_planning(browsers: Browsers, service: Served, folder: Path) -> None:
    id = import_mission(service)
    for theme in ("light", "dark"):
        ann = open_mission(browsers, service, id, color_scheme=theme)
        wait_for_analysis(ann)
        take_picture(ann, folder, theme)
        browsers.close_windows()
    ann = open_mission(browsers, service, id)
    ann.page.get_by_role("treeitem").nth(2).click()
    wait_for_analysis(ann)
    take_picture(ann, folder, "form")
    ann.page.locator("argo-scene").get_by_role("radio", name=re.compile("Floor 1")).click()
    ann.wait_for_scene()
    ann.key("n")
    ann.page.mouse.move(*ann.project(3.05, 4.0, 0.0))
    ann.page.wait_for_timeout(1500)
    ann.wait_for_scene()
    take_picture(ann, folder, "ghost")
    browsers.close_windows()


def picture_plans(browsers: Browsers, service: Served, folder: Path) -> None:
    ann = open_mission(browsers, service, import_mission(service))
    wait_for_analysis(ann)
    ann.key("p")
    expect(ann.page.locator("argo-floor-plans .room svg")).to_be_visible()
    ann.page.wait_for_timeout(500)
    take_picture(ann, folder, "plans")
    browsers.close_windows()


DRAFT = """Hi Lena,
Start in starting area 1.
I'd like to have valve R25.
Next one is checkpoint 3 obviously.
Should it check R18 too?
Check checkpoint 5.
End in starting area 1.
Thanks, Paul
"""


def picture_draft(browsers: Browsers, service: Served, folder: Path) -> None:
    params = {"filename": "round.txt"}
    draft = service.client.post("/api/imports", params=params, content=DRAFT).json()
    ann = browsers.person(f"http://{service.address}/?token={ALL}", "Ann")
    ann.open(f"/drafts/{draft['id']}")
    expect(ann.page.locator("argo-draft .line:focus")).to_have_count(1)
    ann.key("c")
    expect(ann.page.locator("#saved")).to_have_text("Saved")
    take_picture(ann, folder, "draft")
    browsers.close_windows()


def picture_run(browsers: Browsers, service: Served, folder: Path) -> None:
    id = import_mission(service)
    ann = open_mission(browsers, service, id)
    ann.wait_for_scene()
    ann.page.get_by_role("tab", name="Run").click()
    ann.page.locator("argo-run").get_by_role("button", name="Start the run", exact=True).click()
    expect(ann.page.locator("#speed")).to_be_visible()
    ann.page.locator("#speed").select_option("10")
    ann.wait_until(
        lambda: service.client.get("/api/runs").json()["runs"][0]["readings"], "there is a reading"
    )
    ann.page.wait_for_timeout(500)
    take_picture(ann, folder, "run")
    phone = open_mission(browsers, service, id, viewport={"width": 400, "height": 850})
    phone.page.locator("#tab-run").click()
    expect(phone.page.locator("argo-scene .loading")).to_be_hidden()
    phone.page.wait_for_timeout(3000)
    take_picture(phone, folder, "phone")
    ann.page.locator("argo-run").get_by_role("button", name="Take over", exact=True).click()
    give_back = ann.page.locator("argo-run").get_by_role("button", name="Give back", exact=True)
    expect(give_back).to_be_enabled()
    ann.page.wait_for_timeout(5000)  # the robot stands still, and the scene is drawn finely
    ann.wait_for_scene()
    take_picture(ann, folder, "taken-over")
    browsers.close_windows()


def picture_evaluation(browsers: Browsers, service: Served, folder: Path) -> None:
    id = import_mission(service)
    ann = open_mission(browsers, service, id)
    wait_for_analysis(ann)
    page = ann.page
    page.locator("#tab-evaluate").click()
    page.locator("argo-evaluate-start summary").click()
    for fault in ("low_battery", "drive_dysfunction"):
        page.locator("argo-evaluate-start argo-faults select").select_option(fault)
    page.locator("input[name=require]").fill("60")
    page.locator("argo-evaluate-start select[name=worlds]").select_option("1000")
    page.locator("#evaluate").click()
    result = page.locator("argo-evaluate-result section")
    page.locator("argo-evaluate-start summary").click()
    expect(page.locator("#rate")).to_be_visible()
    expect(result).to_have_attribute("data-state", "done", timeout=600_000)
    ann.wait_for_scene()
    take_picture(ann, folder, "evaluated")
    page.locator("#failing button").first.click()
    expect(page.locator("#evaluated")).to_be_visible()
    ann.wait_for_scene()
    take_picture(ann, folder, "replayed")
    browsers.close_windows()


def main(folder: Path) -> None:
    site = open_site("umad").prepare()
    with tempfile.TemporaryDirectory() as missions, served(Path(missions), site) as service:
        browsers = Browsers()
        picture_home(browsers, service, folder)
        picture_planning(browsers, service, folder)
        picture_plans(browsers, service, folder)
        picture_draft(browsers, service, folder)
        picture_evaluation(browsers, service, folder)
        picture_run(browsers, service, folder)
        browsers.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
