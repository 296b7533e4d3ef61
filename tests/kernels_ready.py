"""Compile the damper's kernels once, before several processes that would all do it: `python -m tests.kernels_ready`."""

from __future__ import annotations

from dataclasses import replace

from damper import Harmonic, ParticleDamper, backbone, forced, ringdown, ringdowns, sample, stepped_ringdown, working


def main() -> None:
    """Move a ball in every way that has kernels of its own."""
    level = ParticleDamper(
        modal_mass=0.3,
        stiffness=(1e6, 1e6),
        ball_mass=0.002,
        ball_radius=1e-3,
        cavity=(2.5e-3, 2.5e-3),
        centrifugal_acceleration=1e5,
        restitution=0.5,
        friction=0.3,
        rolling_friction=1e-4,
        damping_ratio=1e-3,
    )
    force = Harmonic(level.stiffness[0] ** 0.5, (5.0, 0.0))
    for damper in (level, replace(level, floor_tilt=(5.0, 5.0))):
        sample(ringdown(damper, (1e-3, 0.0), 3, keep_events=True), [1e-4])
        ringdowns(damper, [(1e-3, 0.0)], 3)
        working(damper)
    forced(level, [force])
    backbone(level)
    stepped_ringdown(level, (1e-3, 0.0), 3)


if __name__ == "__main__":
    main()
