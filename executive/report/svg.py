"""Hand-made SVG: elements as strings, paths, and numbers short enough to read."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape


def number(value: float) -> str:
    """A coordinate in at most a hundredth of a pixel."""
    return f"{value:.2f}".rstrip("0").rstrip(".") if value == value else "0"


def element(tag: str, *children: str, **attributes: object) -> str:
    """`<tag …>children</tag>`; underscores in attribute names stand for hyphens, None leaves one out."""
    written = "".join(
        f' {name.rstrip("_").replace("_", "-")}="{_attribute(value)}"'
        for name, value in attributes.items()
        if value is not None
    )
    return f"<{tag}{written}>{''.join(children)}</{tag}>" if children else f"<{tag}{written}/>"


def _attribute(value: object) -> str:
    return number(value) if isinstance(value, float) else escape(str(value), quote=True)


def title(text: str) -> str:
    """What shows on hovering."""
    return f"<title>{escape(text)}</title>"


def text(x: float, y: float, words: str, **attributes: object) -> str:
    """A line of text with its baseline at (x, y)."""
    return element("text", escape(words), x=x, y=y, **attributes)


def points(xy: Iterable[Sequence[float]]) -> str:
    """Coordinates for a polyline or polygon."""
    return " ".join(f"{number(x)},{number(y)}" for x, y in xy)


def polyline(xy: Iterable[Sequence[float]], **attributes: object) -> str:
    return element("polyline", points=points(xy), fill="none", **attributes)


def polygon(xy: Iterable[Sequence[float]], **attributes: object) -> str:
    return element("polygon", points=points(xy), **attributes)


def line(x1: float, y1: float, x2: float, y2: float, **attributes: object) -> str:
    return element("line", x1=x1, y1=y1, x2=x2, y2=y2, **attributes)


def drawing(width: float, height: float, body: Iterable[str], **attributes: object) -> str:
    """A whole inline drawing that scales with the page."""
    return element("svg", *body, viewBox=f"0 0 {number(width)} {number(height)}", role="img", **attributes)
