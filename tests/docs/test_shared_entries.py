import pytest

pytest.importorskip("griffe", reason="comes with the extra docs")


def test_names_that_share_an_entry_get_one_each_with_all_of_its_lines() -> None:
    from docs.generate.shared_entries import split

    docstring = "Attributes:\n    x, y: centre,\n        in pixels.\n    w: one, two: three.\n"
    assert split(docstring) == (
        "Attributes:\n    x: centre,\n        in pixels.\n    y: centre,\n        in pixels.\n    w: one, two: three.\n"
    )
