"""`python -m docs.generate`: make the generated parts of the pages anew, and name the pages that changed."""

from __future__ import annotations

from docs.generate.parts import outdated_pages


def main() -> None:
    """Write the pages that are not what they should be."""
    for path, text in outdated_pages():
        path.write_text(text, encoding="utf-8")
        print(path)


if __name__ == "__main__":
    main()
