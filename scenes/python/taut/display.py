"""Simulations that show themselves in a notebook."""

from __future__ import annotations

import html

from ._taut import Film, Simulator


def show(film: Film | Simulator, height: int = 480) -> str:
    """An iframe of this height [pixels] with the page of a film, or of the present instant of a simulator."""
    if isinstance(film, Simulator):
        film = Film(film)
        film.sample(now=True)
    page = html.escape(film.page(), quote=True)
    return f'<iframe srcdoc="{page}" style="width: 100%; height: {height}px; border: 0"></iframe>'


def _repr_html_(self: Film | Simulator) -> str:
    try:
        return show(self)
    except (ValueError, RuntimeError) as error:  # no frames, or no three.js
        return f"<p>{html.escape(repr(self))}: {html.escape(str(error))}</p>"


Film._repr_html_ = _repr_html_  # type: ignore[attr-defined]
Simulator._repr_html_ = _repr_html_  # type: ignore[attr-defined]
