"""What differs between two runs: the same quantity of the same mode at the same speed."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from workflows.solve.records import Mode, SpeedPoint
from workflows.wording import whole

_NAMED = 3
"""Speeds that are named one by one; of more, the range is given."""


@dataclass(frozen=True)
class Changes:
    """Relative changes (with - without) / without, the largest over the speeds, and what no number can say.

    Attributes:
        relative: by quantity; None where no speed has a value on both sides.
        remarks: quantities that are there on one side only, speeds at which the plate diverges on one side only.
    """

    relative: dict[str, float | None]
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class _Pair:
    """A quantity with an effect and without it, at one speed."""

    rpm: float
    with_it: float | None
    without: float | None

    @property
    def change(self) -> float | None:
        if self.with_it is None or self.without is None:
            return None
        if self.with_it == self.without:
            return 0.0
        return None if self.without == 0 else (self.with_it - self.without) / self.without


def changes(own: tuple[SpeedPoint, ...], other: tuple[SpeedPoint, ...], *, own_has_it: bool) -> Changes:
    """What an effect changes, between a scene's own run and the other; frequencies are numbered as in the own run."""
    mine, others = ({point.rpm: point for point in points} for points in (own, other))
    pairs: dict[str, list[_Pair]] = {}
    for rpm in mine:
        if rpm not in others:
            continue
        for name, (here, there) in _values(mine[rpm], others[rpm]).items():
            pair = _Pair(rpm, here, there) if own_has_it else _Pair(rpm, there, here)
            pairs.setdefault(name, []).append(pair)
    relative = {name: _largest(found) for name, found in pairs.items()}
    with_it, without = (mine, others) if own_has_it else (others, mine)
    remarks = [_diverging("with", set(without) - set(with_it)), _diverging("without", set(with_it) - set(without))]
    for name, found in pairs.items():
        remarks += _one_sided(name, found)
    return Changes(relative, tuple(remark for remark in remarks if remark))


def _values(own: SpeedPoint, other: SpeedPoint) -> dict[str, tuple[float | None, float | None]]:
    """Headline quantities of two runs at one speed."""
    partners = _partners(own.modes, other.modes)
    found: dict[str, tuple[float | None, float | None]] = {}
    for number, (mode, partner) in enumerate(zip(own.modes, partners, strict=True), 1):
        found[f"frequency_{number}"] = mode.frequency_hz, None if partner is None else partner.frequency_hz
    if own.damping is not None and other.damping is not None:
        for name in ("cutoff_g", "peak_sdc", "impacts"):
            found[name] = getattr(own.damping, name), getattr(other.damping, name)
        figures = [point.level or point.working for point in (own, other)]
        here, there = (None if known is None or not known.peak > 0 else known.peak for known in figures)
        found["ball_damping_ratio"] = here, there
        found["ball_share"] = own.damping.energy.ball_share, other.damping.energy.ball_share
    return found


def _partners(own: tuple[Mode, ...], other: tuple[Mode, ...]) -> list[Mode | None]:
    """For each mode the other run's of the same family and the same number within it, if that was solved for."""
    families: dict[str, list[Mode]] = defaultdict(list)
    for mode in other:
        families[mode.family].append(mode)
    waiting = {family: iter(modes) for family, modes in families.items()}
    return [next(waiting.get(mode.family, iter(())), None) for mode in own]


def _largest(pairs: list[_Pair]) -> float | None:
    known = [pair.change for pair in pairs if pair.change is not None]
    return max(known, key=abs, default=None)


def _one_sided(name: str, pairs: list[_Pair]) -> list[str]:
    """Where a quantity is there on one side only, so that its change has no number."""
    odd = [pair for pair in pairs if pair.change is None and (pair.with_it, pair.without) != (None, None)]
    only_with = [pair.rpm for pair in odd if not pair.without]
    only_without = [pair.rpm for pair in odd if pair.without]
    if name.startswith("frequency"):
        return [f"{name} has no partner of its family {_at(only_with + only_without)}"] if odd else []
    return [
        f"{name} is there only {side} it, {_at(speeds)}"
        for side, speeds in (("with", only_with), ("without", only_without))
        if speeds
    ]


def _diverging(side: str, speeds: Iterable[float]) -> str:
    found = list(speeds)
    return f"{side} it the plate diverges {_at(found)}" if found else ""


def _at(speeds: list[float]) -> str:
    ordered = sorted(speeds)
    if len(ordered) <= _NAMED:
        return f"at {', '.join(f'{whole(rpm)}' for rpm in ordered)} rpm"
    return f"at {len(ordered)} speeds from {whole(ordered[0])} to {whole(ordered[-1])} rpm"
