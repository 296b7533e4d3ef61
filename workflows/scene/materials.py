"""Materials by name: a few, each with its source. What a scene resolves to are the numbers.

Elastic constants and densities are those at room temperature. A ball needs a density alone.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Substance:
    """Density [kg/m^3] and its source; of what plates are made of, Young's modulus [Pa] and Poisson's ratio as well."""

    density: float
    source: str
    youngs_modulus: float | None = None
    poissons_ratio: float | None = None


def _plate(youngs_modulus: float, poissons_ratio: float, density: float, source: str) -> Substance:
    return Substance(density, source, youngs_modulus, poissons_ratio)


KNOWN = {
    "steel": _plate(210e9, 0.3, 7850.0, "EN 1993-1-1, 3.2.6; EN 1991-1-1, Table A.4"),
    "stainless steel": _plate(200e9, 0.3, 7900.0, "EN 1993-1-4, 2.1.3; EN 10088-1, grade 1.4301"),
    "aluminium": _plate(70e9, 0.3, 2700.0, "EN 1999-1-1, 3.2.5"),
    "Ti-6Al-4V": _plate(113.8e9, 0.342, 4430.0, "ASM Aerospace Specification Metals, grade 5, annealed"),
    # 29.0e6 psi at 70 °F, 0.297 lb/in^3 aged.
    "Inconel 718": _plate(200e9, 0.29, 8220.0, "Special Metals, SMC-045"),
    # WC at 15.6 g/cm^3 with 6 % by mass of cobalt at 8.86 g/cm^3.
    "tungsten carbide": Substance(14_900.0, "WC with 6 % cobalt, from the densities of the CRC Handbook"),
    "tungsten": Substance(19_300.0, "CRC Handbook of Chemistry and Physics"),
    "lead": Substance(11_300.0, "CRC Handbook of Chemistry and Physics"),
}
"""By the names that a scene may give."""

PLATES = tuple(name for name, substance in KNOWN.items() if substance.youngs_modulus is not None)
BALLS = tuple(KNOWN)
