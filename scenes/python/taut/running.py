"""Whole runs."""

from __future__ import annotations

import os
import warnings

from ._taut import Film, Scene, Settings, Simulator, World


def simulate(
    what: Scene | World | Simulator,
    duration: float | None = None,
    dt: float | None = None,
    *,
    settings: Settings | None = None,
    frames_per_second: float = 60,
    file: str | os.PathLike[str] = "",
) -> Film:
    """Steps a scene, a world or a simulator for `duration` by steps of dt [s], and returns its film.

    A scene has a duration, a dt and settings of its own; else these are 1 s and 1/240 s.  Ends, with a warning, behind a step
    that has not advanced; `film.simulator.report` says why.  Ends, too, with an event that ends the run.  With a file the recording is kept.
    """
    scene = None
    if isinstance(what, Simulator):
        if settings is not None:
            raise ValueError("simulate: a simulator has its settings already")
        simulator = what
    elif isinstance(what, World):
        simulator = Simulator(what, settings or Settings())
    else:
        scene = what
        simulator = Simulator(scene.world, settings or scene.settings)
        simulator.set_events(scene.events)
    dt = dt if dt is not None else scene.dt if scene else 1 / 240
    duration = duration if duration is not None else scene.duration if scene else 1.0
    if not dt > 0:
        raise ValueError(f"simulate: dt must be positive (value: {dt})")
    if scene and scene.assemble and not simulator.assemble().ok():
        raise ValueError(f"simulate: {simulator.report.message}")
    film = Film(simulator, scene, file=file, frames_per_second=frames_per_second)
    film.sample()
    status, message = "success", ""
    for _ in range(round(duration / dt)):
        report = simulator.step(dt)
        if not report.ok():
            status, message = report.status.name.lower().replace("_", " "), report.message
            warnings.warn(f"the simulation ended at t = {simulator.world.time:.6g} s: {message}", stacklevel=2)
            break
        film.sample()
        if any(event.ends_run for event in report.events):
            message = f"ended by event {simulator.ended_by}"
            break
    film.sample(now=True)
    film.finish(status, message)
    return film
