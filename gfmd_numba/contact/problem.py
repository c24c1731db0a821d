"""The dimensionless problem of one contact, its surface and its identity: equal problems are solved once.

The version of results is a hash of the observables that are stored and of the code that made them. Lengths are in L_x,
heights in g L_x and stresses in g E*, g the rms gradient.
"""

import hashlib
import json
import re
from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Literal

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.observables import OBSERVABLES, PATH_OBSERVABLES, ROUGH_BODY_OBSERVABLES
from gfmd_numba.contact.state import LoadStep, Process
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.plastic_sublayers import PlasticSublayers
from gfmd_numba.elasticity.prony import PronySeries
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.surfaces import SmoothSurface, SummedSurface, Surface
from gfmd_numba.scene.interface_records import LAWS
from gfmd_numba.scene.records import ends_of
from gfmd_numba.solvers.table import SOLVERS, Options

_TABLES = OBSERVABLES, PATH_OBSERVABLES, ROUGH_BODY_OBSERVABLES
_MAKE_NO_NUMBERS = {"analysis", "campaign", "cli", "scene", "simulate", "storage", "text"}  # of what a shard holds
_TEXT = rb'"""(?s:.*?)"""'
_PROSE = re.compile(  # lines of comments and docstrings, and empty ones; a text that is no docstring stays
    rb"^[ \t]*(?P<prose>#.*|[rR]?" + _TEXT + rb")?[ \t]*\n|(?P<kept>" + _TEXT + rb")", re.MULTILINE
)


@dataclass(frozen=True)
class DeformableBody:
    """One of the bodies of a contact, in its own E*: a counter body, or one whose topography is followed.

    `compliance_fraction` is its part E*/E_i* of the compliance 1/E*. `part` is the number of the summed surface that is
    its own, None if it is flat. `side` is -1 for the upper body of two, whose tangential tractions are the opposite
    ones.
    """

    elastic: ElasticBody
    compliance_fraction: float
    part: int | None = None
    side: int = 1


@dataclass(frozen=True)
class RoughBodies:
    """Deformable bodies whose topographies are followed to an `order` in the slope."""

    bodies: tuple[DeformableBody, ...]
    order: int


@dataclass(frozen=True)
class Tractions:
    """Tractions on the body out of it `[(ny,) nx]` and along it `[component, (ny,) nx]`, along x first, in g E*."""

    digest: str
    tangential: Reals = field(repr=False, compare=False)
    normal: Reals = field(repr=False, compare=False)

    @classmethod
    def of(cls, tangential: Reals, normal: Reals) -> "Tractions":
        """Return tractions with what tells them from others."""
        return cls(hashlib.sha256(tangential.tobytes() + normal.tobytes()).hexdigest(), tangential, normal)


@dataclass(frozen=True)
class Effect:
    """One effect of the scene, its `state` (on, off, condensed or dropped), and the reason."""

    name: str
    state: str
    reason: str


@dataclass(frozen=True, slots=True)  # there may be a million
class Problem:
    """Heights in g L_x, stresses in g E*; one of the two loads is None.

    `path` are the steps after this load; each begins where the last one ended. If topographies are followed, `rough`
    has the bodies, and the surface is the sum of their surfaces. A viscoelastic body has a `relaxation`, whose relaxed
    modulus is E*. A punch wears by `wear_rate` (in 1 / g E*) times pressure and way. Relaxation and wear have an error
    of `time_tolerance` along the path. `processes` happen in addition. `sliding` of the punch (none: 0), `duration` and
    `speed` are those of the load, as in a `LoadStep`. A punch that slides over a body that creeps is moved along it by
    `passing` (g) times the sliding, in L_x; None: each node keeps facing the same one. A surface that is not `periodic`
    is a window, around which the body is free; "x", "y": on both sides along the other axis alone. The period holds a
    mirrored field, and each of its contacts, `fields_in_period` times.
    """

    surface: Surface
    body: ElasticBody
    interface: Interactions
    mean_pressure: float | None
    displacement: float | None
    numerics: Options
    tractions: Tractions | None = None
    counter: DeformableBody | None = None
    path: tuple[LoadStep, ...] = ()
    rough: RoughBodies | None = None
    processes: tuple[Process, ...] = ()
    sliding: tuple[float, ...] = ()
    duration: float = 0.0
    speed: float = 0.0
    periodic: bool | Literal["x", "y"] = True
    relaxation: PronySeries | None = None
    time_tolerance: float | None = None
    wear_rate: float | None = None
    passing: float | None = None
    plasticity: PlasticSublayers | None = None
    fields_in_period: int = 1
    _identity: str = field(default="", init=False, repr=False, compare=False)

    @property
    def identity(self) -> str:
        """Hash of everything that decides the numbers: equal problems are solved once.

        The text of a problem names all its classes and numbers; arrays stand in it by their digests.
        """
        if not self._identity:
            digest = hashlib.sha256(repr((results_version(), self)).encode()).hexdigest()[:24]
            object.__setattr__(self, "_identity", digest)
        return self._identity

    @property
    def ends(self) -> tuple[bool, ...]:
        """Whether the punch ends along (y,) x, where the body is free around it."""
        return ends_of(self.periodic, len(self.surface.shape))

    @property
    def n_loads(self) -> int:
        """Number of loads that are solved one after another: one without a path."""
        return 1 + len(self.path)

    @property
    def has_form(self) -> bool:
        """Whether the punch has a smooth form."""
        parts = self.surface.parts if isinstance(self.surface, SummedSurface) else ()
        return any(isinstance(part.surface, SmoothSurface) for part in parts)

    @property
    def load(self) -> float:
        """The load before the path: the mean pressure, or the displacement of the punch."""
        load = self.displacement if self.mean_pressure is None else self.mean_pressure
        assert load is not None  # one of the two is given
        return load

    @property
    def step(self) -> LoadStep:
        """The load before the path, with the sliding of the punch."""
        return LoadStep(self.load, self.sliding or (0.0,) * len(self.surface.shape), self.duration, self.speed)

    @property
    def at_each_load(self) -> tuple["Problem", ...]:
        """The problem at its own load, and at each one of its path, without the path."""
        return tuple(self.under(step) for step in (self.step, *self.path))

    def under(self, step: LoadStep) -> "Problem":
        """The same problem at another load of the same kind, without a path."""
        pressure, displacement = (step.load, None) if self.displacement is None else (None, step.load)
        moved = replace(self, sliding=step.sliding, duration=step.duration, speed=step.speed, path=())
        return replace(moved, mean_pressure=pressure, displacement=displacement)


_PACKAGE = Path(__file__).parent.parent


@lru_cache(maxsize=1)
def results_version() -> str:
    """Hash of the code that makes numbers and of the tables' rows: shards of another version are not used.

    Comments and docstrings count for nothing.
    """
    decided = {
        "code": code_digest(_PACKAGE),
        "observables": [(name, row.of, row.unit) for table in _TABLES for name, row in table.items()],
        "solvers": {name: asdict(row) | {"sentence": ""} for name, row in SOLVERS.items()},
        "laws": {name: (sorted(row.model_fields), row.implementation) for name, row in LAWS.items()},
    }
    return hashlib.sha256(json.dumps(decided, sort_keys=True, default=sorted).encode()).hexdigest()[:12]


def code_digest(package: Path) -> str:
    """SHA-256 of the modules of a package that make numbers, without their prose: all but those of rooms known not to.

    What scenes and campaigns describe is in the identity of each problem, number by number.
    """
    digest = hashlib.sha256()
    for file in sorted(package.rglob("*.py")):
        module = file.relative_to(package).as_posix()
        if module.partition("/")[0] not in _MAKE_NO_NUMBERS:
            code = _PROSE.sub(rb"\g<kept>", file.read_bytes().replace(b"\r\n", b"\n"))
            digest.update(f"{module} {len(code)}\n".encode() + code)
    return digest.hexdigest()
