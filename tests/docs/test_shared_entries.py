from docs.generate.shared_entries import split


def test_names_that_share_an_entry_get_one_each_with_all_of_its_lines() -> None:
    shared = "Attributes:\n    x, y: centre,\n        in pixels.\n    w: one, two: three.\n"
    x, y = ("    " + name + ": centre,\n        in pixels.\n" for name in "xy")
    assert split(shared) == f"Attributes:\n{x}{y}    w: one, two: three.\n"
