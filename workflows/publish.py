"""Writing a run: every file of a result folder, or none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from workflows import report, results_files, results_json, store
from workflows.mode_shape import Artist
from workflows.records import Results
from workflows.stages import Stages


def publish(results: Results, out: Path, stages: Stages, artist: Artist | None = None) -> Results:
    """Write a run into `out` and return it with its final times.

    Raises:
        BadInput: `out` cannot be written.
    """
    with store.replacing(out) as folder:
        with stages("write"):
            results_files.write_csv(results, folder)
            results_files.write_netcdf(results, folder / "results.nc")
            if results.surface is not None:
                results_files.write_vtu(results.surface, results, folder / "modes.vtu")
        with stages("report"):
            drawings = report.draw(results)
            if artist is not None:  # asked last: it draws in a process of its own meanwhile
                drawings = replace(drawings, shape=artist.picture())
        # The times of the last two files cannot stand in them: they are left out, some hundredths of a second.
        finished = replace(results, timings=stages.timings())
        (folder / "report.html").write_text(report.render(finished, drawings), encoding="utf-8")
        (folder / "results.json").write_text(results_json.dumps(finished) + "\n", encoding="utf-8")
    return finished
