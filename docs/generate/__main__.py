"""`python -m docs.generate`: regenerate parts of pages, and print the pages that changed."""

from __future__ import annotations

from docs.generate.parts import outdated_pages


def main() -> None:
    """Write the outdated pages."""
    for path, text in outdated_pages():
        path.write_text(text, encoding="utf-8")
        print(path)


if __name__ == "__main__":
    main()
