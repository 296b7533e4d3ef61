"""Whether a scene has an effect, once that is decided."""

from __future__ import annotations

from dataclasses import dataclass, field

from workflows.effects.left_out import LeftOut


@dataclass(frozen=True)
class Effect:
    """Whether an effect is simulated, why (not), and what it would move where it is not, as far as that is known."""

    on: bool
    why: str
    left_out: LeftOut | None = field(default=None, repr=False, compare=False)
