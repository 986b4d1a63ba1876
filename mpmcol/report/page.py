"""From the content of a report to HTML."""

from __future__ import annotations

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from mpmcol import __version__
from mpmcol.report.model import Page

TEMPLATE = "report.html.j2"


def render_page(page: Page) -> str:
    """The report as one HTML document, which needs no other file and no network."""
    environment = Environment(
        loader=PackageLoader("mpmcol.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["trusted"] = Markup  # for the output of the Markdown library
    return environment.get_template(TEMPLATE).render(page=page, version=__version__)
