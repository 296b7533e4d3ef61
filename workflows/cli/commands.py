"""The commands of `spindamp`: a function each that reads options, calls what Python can call too, and prints.

A new command is such a function under `@_command()`. What a command needs is imported inside it, so that
light commands start fast.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer
from typer.core import TyperCommand, TyperGroup, TyperOption

from workflows.errors import BadInput, NoAnswer
from workflows.formatting import plain
from workflows.progress import LOG, Stages
from workflows.versions import versions

if TYPE_CHECKING:
    from workflows.io.files import StudyResult
    from workflows.scene.load import SceneFile
    from workflows.studies.sweep.executor import Workers

Scene = Annotated[
    str,
    typer.Argument(metavar="[SCENE]", help="Scene file (TOML), or the name of a shipped scene.", show_default=True),
]
Out = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Folder for the results; replaced whole or not at all.")
]
Processes = Annotated[
    int | None,
    typer.Option("--workers", metavar="N", help="Worker processes on this machine; default: one for each core."),
]
Dask = Annotated[
    str | None, typer.Option("--dask", metavar="ADDRESS", help="Address of a Dask scheduler, whose workers compute.")
]
Seed = Annotated[int, typer.Option("--seed", metavar="N", help="Seed of the random numbers.")]
Json = Annotated[bool, typer.Option("--json", help="Print the machine-readable result and nothing else.")]
_RANGES = "START:STOP:COUNT, log:START:STOP:COUNT or a,b,c, with units; repeat the option for each key."
Vary = Annotated[list[str] | None, typer.Option("--vary", metavar="KEY=VALUES", help=_RANGES)]
Count = Annotated[
    int | None, typer.Option("--sample", metavar="N", help="Spread N points over all ranges instead of a grid.")
]
Quick = Annotated[bool, typer.Option("--quick", help="Measure with fewer and faster sweeps, mostly within 1 %.")]
_DISTRIBUTIONS = "Treat ranges (or normal:MEAN:DEVIATION) as distributions; report percentiles and Sobol' indices."
Uncertain = Annotated[bool, typer.Option("--uncertain", help=_DISTRIBUTIONS)]


def _refuse_repeated(command: TyperCommand | TyperGroup, ctx: Any, args: list[str]) -> None:
    """Refuse an option of one value that is given twice: typer would take the last."""
    if ctx.resilient_parsing:
        return
    _, _, order = command.make_parser(ctx).parse_args(args=list(args))
    for option, times in Counter(each for each in order if isinstance(each, TyperOption)).items():
        if times > 1 and not option.multiple and not option.is_flag:
            raise BadInput(f"given {times} times: expected once", key=option.opts[0])


class _Command(TyperCommand):
    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        _refuse_repeated(self, ctx, args)
        return super().parse_args(ctx, args)


class _Commands(TyperGroup):
    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        _refuse_repeated(self, ctx, args)
        return super().parse_args(ctx, args)


_commands = typer.Typer(pretty_exceptions_enable=False, rich_markup_mode=None)
_command = partial(_commands.command, cls=_Command)

Result = TypeVar("Result", bound="StudyResult")


@_command()
def run(scene: Scene = "paper", out: Out = None, json: Json = False) -> None:
    """Solve structure and damper at every speed; write a report.

    Without --out, the folder is named after the scene's title; with --json and no --out, no files are written.
    """
    source = _load(scene)
    _simulate(source, _folder(out, json, "spindamp", source), json)


@_command()
def campbell(scene: Scene = "paper", out: Out = None, json: Json = False) -> None:
    """Solve the structure alone: frequencies over speed.

    Without --out, no files are written.
    """
    from workflows import pipeline

    _simulate(pipeline.plate_only(_load(scene)), out, json)


@_command()
def ringdown(
    scene: Scene = "paper",
    rpm: Annotated[float | None, typer.Option("--rpm", help="Rotation speed; default: the scene's middle one.")] = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Simulate the damper alone, at one speed.

    Without --out, no files are written.
    """
    from workflows import pipeline
    from workflows.scene.scene import omega_of

    _simulate(pipeline.at_one_speed(_load(scene), None if rpm is None else omega_of(rpm)), out, json)


@_command()
def response(scene: Scene = "paper", out: Out = None, json: Json = False) -> None:
    """Compute the forced response where engine orders cross modes.

    The response is computed without and with the ball, under the forces of the table [excitation].
    Without --out, no files are written.
    """
    from workflows.studies.response import respond

    _study(respond, out, json, _load(scene))


@_command()
def reproduce(out: Out = None, json: Json = False) -> None:
    """Compare every claim of the paper with this code.

    Without --out, no files are written.
    """
    from workflows.studies.reproduction import reproduce

    _study(reproduce, out, json)


@_command()
def accuracy(scene: Scene = "paper", out: Out = None, json: Json = False) -> None:
    """Measure computing time against accuracy.

    The result is a table with plots of error over time.

    Without --out, no files are written.
    """
    from workflows.studies.work_precision.study import study

    _study(study, out, json, _load(scene))


@_command()
def effects(scene: Scene = "paper", out: Out = None, json: Json = False) -> None:
    """Measure what each effect changes, and its computing time.

    Without --out, no files are written.
    """
    from workflows.studies.work_precision.effects import effect_study

    _study(effect_study, out, json, _load(scene))


@_command()
def sweep(
    scene: Scene = "paper",
    vary: Vary = None,
    sample: Count = None,
    quick: Quick = False,
    uncertain: Uncertain = False,
    out: Out = None,
    workers: Processes = None,
    dask: Dask = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Vary keys of a scene over a grid or a sample.

    Example: --vary damper.mass_ratio=0.001:0.01:10. An interrupted sweep resumes with the same command. If no point
    has an answer, the exit status is 3.

    Without --out, the folder is named after the scene's title; with --json and no --out, no files are written.
    """
    from workflows.io import folder
    from workflows.io.files import as_json
    from workflows.studies.sweep import executor, report, store, study

    plan = study.of_scene(scene, vary or (), count=sample, seed=seed, quick=quick, uncertain=uncertain)
    out = _folder(out, json, "spindamp-sweep", _warned(plan.source))
    if out is not None:
        store.check_target(out)
    if not json:
        for axis in plan.plan.axes:
            if instead := axis.key.replaced(plan.source.scene):
                typer.echo(f"{axis.name} replaces the scene's {instead}")
    _announce_compiler()
    pool = executor.workers_of(workers, dask)
    going_on = nullcontext() if out is None else folder.resumable(store.GOES_ON)
    with going_on, Stages(lines=True) as stages:
        data = study.solve(plan, out, pool, stages)
        if out is not None:
            with stages("report"):
                report.write(data, out)
    _show(as_json(report.document(data)) if json else plain(report.text(data)), out, json)
    if problem := report.no_answer(data):
        raise NoAnswer(f"{plan.source.name}: {problem}")


@_command()
def design(
    scene: Scene = "design",
    out: Out = None,
    workers: Processes = None,
    dask: Dask = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Find the best damper within the limits of a scene.

    The table [design] of the scene holds the limits. If no design works, the results state why, and the exit status
    is 3.

    Without --out, the folder is named after the scene's title; with --json and no --out, no files are written.
    """
    from workflows.studies.design import report, study
    from workflows.studies.sweep.executor import workers_of

    def solve(source: SceneFile, stages: Stages) -> report.DesignResult:
        pool = _announced(workers_of(workers, dask))
        return study.design(source, seed=seed, pool=pool, stages=stages, partial_results=partial_results)

    source = _load(scene)
    out = _folder(out, json, "spindamp-design", source)
    partial_results = None if out is None else out.with_name(f"{out.name}.partial")
    best = _study(partial(solve, source), out, json, damper=False)
    if out is not None and not json and best.toml:
        typer.echo(f"or spindamp run {out / 'best.toml'}")
    if not best.optimum.evaluation.works:
        raise NoAnswer(f"{source.name}: {report.in_short(best) if json else 'no design works'}")


@_command()
def compare(
    runs: Annotated[list[str], typer.Argument(metavar="DIR|SCENE...", help="Two or more folders of runs, or scenes.")],
    out: Out = None,
    json: Json = False,
) -> None:
    """Compare runs side by side.

    The result shows where their scenes differ, their verdicts, the figures at each speed and one chart. Without --out,
    no files are written.
    """
    from workflows.studies import comparison

    loaded = [each if Path(each).is_dir() else _load(each) for each in runs]
    _study(lambda stages: comparison.compare(loaded, stages), out, json, read=runs)


@_command()
def modes(
    scene: Scene = "paper",
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="Write a neutral file: a name ending in .npz or .json.")
    ] = None,
    json: Json = False,
) -> None:
    """Write the structure's modes as a file that [structure] modes reads.

    Without --out, the modes are listed.
    """
    from workflows import pipeline
    from workflows.io import files
    from workflows.report import text

    if out is not None:
        files.modes_file(out, "--out")
    with Stages(lines=True) as stages:
        model = pipeline.modes(_load(scene), stages)
    if out is not None:
        files.save_modes(model, out, "--out")
    typer.echo(files.dump_modes(model) if json else text.of_modes(model, out))


@_command()
def view(
    what: Annotated[
        str, typer.Argument(metavar="DIR|SCENE|MESH", help="A folder of results, a scene, or a mesh file.")
    ] = "paper",
    rpm: Annotated[float | None, typer.Option("--rpm", help="Rotation speed; default: the middle one.")] = None,
    mode: Annotated[int, typer.Option("--mode", help="Number of the mode to show first.")] = 1,
    unit: Annotated[
        str | None, typer.Option("--unit", metavar="UNIT", help="Unit of the coordinates in a mesh file, such as mm.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="Write the page to FILE, and do not open it.")
    ] = None,
    json: Json = False,
) -> None:
    """Show mesh, clamped root, place of the damper and modes.

    The command writes a page, prints its name, and opens it in a browser where there is a screen.
    """
    import webbrowser

    from workflows.io.files import as_json
    from workflows.io.folder import writable
    from workflows.report import figures, mode_viewer, viewer
    from workflows.scene.load import slug
    from workflows.scene.scene import as_typed, omega_of

    if out is not None:
        target = writable(out, "--out")
        if target.suffix.lower() != ".html":
            raise BadInput("a page is written: expected a name that ends in .html", key="--out", value=str(out))
        if not target.parent.is_dir():
            raise BadInput("no such folder: expected a file in an existing folder", key="--out", value=str(out))
    if page := viewer.page_of_study(what):
        if json or out is not None:
            raise BadInput(f"holds a study, whose page is {page}: omit --json and --out", file=what)
        typer.echo(f"open {page}")
        return
    omega = None if rpm is None else omega_of(rpm)
    data = viewer.of(what, omega, unit)
    if data.surface.at:
        row = figures.chosen(data.surface, data.speeds, omega, mode, ("--rpm", "--mode"))
        data = replace(data, first=(data.surface.at[row], mode - 1))
    elif rpm is not None:
        raise BadInput("a mesh alone has no speeds: leave it out", key="--rpm", value=as_typed(rpm))
    if json:
        if out is not None:
            viewer.write(data, out)
        shown = {"rpm": data.speeds[data.first[0]].rpm, "mode": mode} if data.surface.at else {}
        typer.echo(as_json({"title": data.title, "file": out and str(out), **shown, **data.numbers}))
        return
    for name, words in data.facts:
        typer.echo(f"{name:<14} {words}")
    if data.thinned:
        typer.echo(data.thinned)
    path = out or Path(f"spindamp-view-{slug(data.title)}.html")
    viewer.write(data, path)
    if out is None and mode_viewer.screen_exists():
        webbrowser.open(path.resolve().as_uri())
    typer.echo(f"\nopen {path}")


@_command()
def check(
    scene: Annotated[str, typer.Argument(metavar="SCENE", help="Scene file (TOML), or the name of a shipped scene.")],
    json: Json = False,
) -> None:
    """Validate a scene and print all its values.

    The output includes the effects that the scene calls for, the reason for each, and the size of a run.
    """
    from workflows.io import files, provenance
    from workflows.solve import resources
    from workflows.solve.blade import space_of
    from workflows.solve.model_choice import choose_model, translated_errors

    source = _load(scene)
    resources.check(source)
    choice = choose_model(source, Stages(visible=False))
    planform = None if source.mesh is None else choice.form
    sizes = resources.sizes(source, choice.form, choice.effects, choice.model)
    with translated_errors(source):
        space = space_of(source, slowest=True)
    if json:
        record = provenance.document(source, choice.effects, choice.theory, planform, space)
        typer.echo(files.as_json(record | {"sizes": vars(sizes)}))
        return
    typer.echo("\n".join(provenance.heading(source, planform, space)))
    typer.echo(provenance.as_toml(source.scene, choice.effects, choice.theory))
    typer.echo(f"\n# {sizes}")


COMMANDS = tuple(each.callback for each in _commands.registered_commands if each.callback is not None)
"""All commands, in the order of --help, which is that of this module."""


def _load(scene: str) -> SceneFile:
    from workflows.scene.load import load

    return _warned(load(scene))


def _warned(source: SceneFile) -> SceneFile:
    """The same, once a terminal, or a log, has what is doubtful in how it is written, whatever is printed otherwise."""
    for remark in source.remarks:
        typer.echo(f"spindamp: WARNING: {source.name}: {remark}", err=True)
    return source


def _simulate(source: SceneFile, out: Path | None, json: bool) -> None:
    """Run a scene, write it to `out` if there is one, and print the result."""
    from workflows import pipeline
    from workflows.io import files, folder, serialise
    from workflows.report import text
    from workflows.report.remarks import remarked
    from workflows.solve import resources

    resources.check(source)
    if out is not None:
        folder.check(out, files.FILES, source.name)
    if source.scene.damper is not None:
        _announce_compiler()
    with Stages(lines=True) as stages:
        state = pipeline.structure(source, stages, shapes=out is not None)
        results = remarked(pipeline.results(pipeline.damped(state, stages), stages))
        if out is not None:
            from workflows.report.page import publish

            results = publish(results, out, stages)
    typer.echo(serialise.dumps(results) if json else plain(text.text(results, out, state.source.remarks)))


def _study(
    solve: Callable[..., Result],
    out: Path | None,
    json: bool,
    *of: SceneFile,
    damper: bool = True,
    read: Sequence[str] = (),
) -> Result:
    """Solve, write into `out` if there is one, and print the result, which is returned.

    `of`: a study of one scene; `read`: other scenes and folders of runs that it reads.
    """
    from workflows.io import files, folder

    if out is not None:
        folder.check(out, files.FILES_OF_STUDIES, *(source.name for source in of), *read)
    if damper and all(source.scene.damper is not None for source in of):
        _announce_compiler()
    with Stages(lines=True) as stages:
        result = solve(*of, stages)
        if out is not None:
            with stages("report"):
                files.write_study(result, out)
    _show(files.as_json(result.document()) if json else repr(result), out, json)
    return result


def _show(text: str, out: Path | None, json: bool) -> None:
    typer.echo(text)
    if out is not None and not json:
        typer.echo(f"\nopen {out / 'report.html'}")


def _folder(out: Path | None, json: bool, prefix: str, source: SceneFile) -> Path | None:
    """Where to write without --out: a folder named after the scene's title, or nowhere with --json."""
    from workflows.scene.load import slug

    return out if out is not None or json else Path(f"{prefix}-{slug(source.scene.title)}")


@contextmanager
def _announced(pool: AbstractContextManager[Workers]) -> Iterator[Workers]:
    """Workers, announced before the first of them starts; a design that needs none does not load the compiler."""
    _announce_compiler()
    with pool as workers:
        yield workers


def _announce_compiler() -> None:
    """Why a start is slow: compiled code is not there yet (on a terminal, as progress is), not kept, or not wanted."""
    from damper import compiled

    if not compiled.COMPILES:
        slow = "a hundred times slower, and results do not wait for their self-check"
        problem = f"NUMBA_DISABLE_JIT: the damper's kernels run as plain Python, {slow}"
    elif not compiled.CACHED:
        why = "neither the installation nor a home folder is writable, so compiled code cannot be stored"
        problem = f"{why}: every start takes some ten seconds longer"
    elif compiled.fresh() and sys.stderr.isatty():
        problem = "compiling the damper's kernels, once for an installation: up to a minute, with their check"
    else:
        return
    typer.echo(f"spindamp: {problem}", err=True)


def _version(requested: bool) -> None:
    if requested:
        typer.echo(f"spindamp {versions()['spindamp']}")
        raise typer.Exit


def _self_check(requested: bool) -> None:
    if requested:
        from workflows.solve import self_check

        _announce_compiler()
        for line in self_check.report():
            print(line, flush=True)
        raise typer.Exit(0 if line == self_check.ALL_PASSED else 1)


def _listen(context: typer.Context, verbose: bool, log: Path | None) -> None:
    """Hand on what the program says of its work, until the command ends."""
    import logging

    try:
        handlers: list[logging.Handler] = [] if log is None else [logging.FileHandler(log, encoding="utf-8")]
    except OSError as error:
        raise BadInput(f"cannot be written: {error.strerror}", file=f"--log {log}") from error
    if verbose:
        handlers.append(logging.StreamHandler())
        handlers[-1].setLevel(logging.INFO)
    for handler in handlers:
        handler.setFormatter(logging.Formatter("%(asctime)s %(message)s"))
        LOG.addHandler(handler)
        context.call_on_close(handler.close)
        context.call_on_close(partial(LOG.removeHandler, handler))
    if handlers:
        LOG.setLevel(logging.DEBUG)
        context.call_on_close(partial(LOG.setLevel, logging.NOTSET))
        LOG.info("spindamp %s: %s", versions()["spindamp"], " ".join(sys.argv[1:]))


_CHECKS = "Compare reference plates and motions with independent results; print the versions."


def _spindamp(
    context: typer.Context,
    show: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
    check: Annotated[bool, typer.Option("--self-check", callback=_self_check, is_eager=True, help=_CHECKS)] = False,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Print choices and progress, with times.")] = False,
    log: Annotated[
        Path | None, typer.Option("--log", metavar="FILE", help="Append the same, in more detail, to FILE.")
    ] = None,
) -> None:
    """Will a particle damper work on a spinning plate or blade, how well, and up to what load?"""  # noqa: D400
    _listen(context, verbose, log)
    if context.invoked_subcommand is None:
        names = ", ".join(command.__name__ for command in COMMANDS)
        raise BadInput(f"missing command: expected one of {names}; `spindamp --help` describes them")


_commands.callback(cls=_Commands, invoke_without_command=True)(_spindamp)

app = typer.main.get_command(_commands)
"""Built once: a Typer that is called reads the signatures of all commands anew."""
