"""The page of hard cases says what the tests say."""

from tests.hard_cases.page import PAGE, cases, page


def test_page_is_up_to_date() -> None:
    assert PAGE.read_text() == page(), "run: python -m tests.hard_cases.page"


def test_every_case_of_the_damper_is_named() -> None:
    """A test among the hard cases without a marker would be missing from the page."""
    for part in ("damper", "plate"):
        path = PAGE.parents[1] / "tests" / "hard_cases" / f"test_{part}.py"
        tests = {line.split("(")[0][4:] for line in path.read_text().splitlines() if line.startswith("def test_")}
        assert {case.test.split("::")[1] for case in cases(f"hard_cases/test_{part}.py")} == tests
