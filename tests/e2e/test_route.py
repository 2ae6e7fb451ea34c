"""`argo route` from a shell, on the competition's site."""

from pathlib import Path

from argo_compiler.checks import check
from argo_compiler.files.mission_file import read_mission


def test_a_script_in_any_order_gets_the_best_order(argo, missions: Path, tmp_path: Path) -> None:
    sheet = (missions / "any_order.txt").read_text(encoding="utf-8").splitlines()
    (tmp_path / "sheet.txt").write_text("\n".join(sheet[:10]) + "\n", encoding="utf-8")
    suggest = ("route", "sheet.txt", "--budget", "20min", "-o", "new.json")
    result = argo(*suggest, cwd=tmp_path, status=0)
    assert "Proven: no order is better" in result.stdout
    assert not check(read_mission(tmp_path / "new.json"))
