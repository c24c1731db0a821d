"""Records of what acts between body and punch; an absent interaction is `None`.

Each law says what computes it and what it asks of a solver, whether its tractions are normal or tangential, whether
they act across an open gap, whether they keep the bodies apart, and whether they need touching nodes. A field of
`Interface` that is a law is its row in `LAWS`.
"""

from itertools import pairwise
from math import inf, isinf
from typing import Annotated, ClassVar, Self, get_args

from pydantic import BaseModel, Field, model_validator

from gfmd_numba.scene.quantities import (
    RECORD,
    FileOfNodes,
    FrictionCoefficient,
    FunctionOfNodes,
    Length,
    Pressure,
    SignedWorkOfAdhesion,
    Speed,
    WearRate,
    WorkOfAdhesion,
    broken_rule,
)


class LawRecord(BaseModel):
    """Record of a law; what its class variables do not say, the law does not do."""

    model_config = RECORD
    title: ClassVar[str]
    implementation: ClassVar[str | None] = None
    normal: ClassVar[bool] = False
    tangential: ClassVar[bool] = False
    across_open_gap: ClassVar[bool] = False
    needs_touching_nodes: ClassVar[bool] = False


class HardWall(LawRecord):
    """Non-overlap constraint; where a hardness is given, the pressure rises to it and the wall then gives way."""

    title: ClassVar = "hard wall"
    ability: ClassVar = "hard wall"
    normal: ClassVar = True
    keeps_apart: ClassVar = True
    hardness: Pressure | None = Field(
        None,
        description="Largest contact pressure in Pa (E* without moduli), where the wall gives way; None: no limit. "
        "For flow inside the body take body.plasticity instead",
    )


class LawOfTheGap(LawRecord):
    """A law of the gap alone."""

    ability: ClassVar = "normal law"
    normal: ClassVar = True
    across_open_gap: ClassVar = True
    work_of_adhesion: SignedWorkOfAdhesion
    range: Length = Field(description="Interaction range, in m if the scene has a length, else in L_x")
    pattern: FileOfNodes | None = Field(
        None, description="File with the share of the work of adhesion that acts at each node; None: all of it"
    )

    pulls_at_no_gap: ClassVar[bool] = True
    leaves_a_gap: ClassVar[bool] = False  # whether it repels so much that nothing touches
    known_from: ClassVar[float] = -inf  # gap, over the range, below which its traction goes on in a line

    @property
    def pull(self) -> float:
        """Traction at no gap over work_of_adhesion / range."""
        return 1.0 if self.pulls_at_no_gap else 0.0


class SignedLaw(LawOfTheGap):
    """A law that attracts or repels at all gaps."""

    work_of_adhesion: SignedWorkOfAdhesion = Field(
        description="Energy per area in J/m^2 (E* L_x without moduli and length); above 0 attracts, below 0 repels"
    )

    @property
    def keeps_apart(self) -> bool:
        """Whether it repels."""
        return self.work_of_adhesion < 0

    @model_validator(mode="after")
    def _acts(self) -> Self:
        if self.work_of_adhesion == 0:
            raise broken_rule(("work_of_adhesion",), "a number other than 0; leave the law out if it does nothing")
        return self


class Exponential(SignedLaw):
    """Finite-range law with energy -work_of_adhesion exp(-gap/range) per area."""

    title: ClassVar = "exponential law"
    implementation: ClassVar = "gfmd_numba.interface.exponential:ExponentialLaw"


class PowerLawOfTheGap(SignedLaw):
    """Law with energy -work_of_adhesion (1 + gap/range)^-exponent per area."""

    title: ClassVar = "power law"
    known_from: ClassVar = -0.9
    implementation: ClassVar = "gfmd_numba.interface.power_laws:ShiftedPowerLaw"
    exponent: float = Field(
        2.0, ge=2.0, le=12.0, description="Power of the distance; van der Waals: 2, retarded 3 (dimensionless)"
    )

    @property
    def pull(self) -> float:
        """Traction at no gap over work_of_adhesion / range."""
        return self.exponent


class Attraction(LawOfTheGap):
    """A law that does not keep the bodies apart."""

    needs_touching_nodes: ClassVar = True
    keeps_apart: ClassVar = False
    work_of_adhesion: WorkOfAdhesion


class SquaredExponential(Attraction):
    """Attraction with energy -work_of_adhesion exp(-(gap/range)^2 / 2) per area."""

    title: ClassVar = "squared exponential law"
    pulls_at_no_gap: ClassVar = False
    implementation: ClassVar = "gfmd_numba.interface.squared_exponential:SquaredExponentialLaw"
    range: Length = Field(description="Gap of the largest attraction, in m if the scene has a length, else in L_x")


class MaugisDugdale(Attraction):
    """Constant attraction of work_of_adhesion/range, which falls to 0 around a gap of one range."""

    title: ClassVar = "Maugis-Dugdale law"
    implementation: ClassVar = "gfmd_numba.interface.maugis_dugdale:MaugisDugdaleLaw"
    range: Length = Field(description="Gap up to which it attracts, in m if the scene has a length, else in L_x")
    taper: float = Field(
        0.2, ge=0.01, le=2.0, description="Gaps over which the attraction falls to 0, over the range (dimensionless)"
    )


class LennardJones(LawOfTheGap):
    """Lennard-Jones attraction and repulsion of two half-spaces, integrated over their atoms."""

    title: ClassVar = "Lennard-Jones law"
    pulls_at_no_gap: ClassVar = False  # it repels there
    leaves_a_gap: ClassVar = True
    known_from: ClassVar = 0.5
    implementation: ClassVar = "gfmd_numba.interface.power_laws:LennardJonesLaw"
    keeps_apart: ClassVar = True
    work_of_adhesion: WorkOfAdhesion
    range: Length = Field(description="Gap at which nothing acts, in m if the scene has a length, else in L_x")


class Cohesive(LawRecord):
    """Xu and Needleman's cohesive law of gap and slip together."""

    title: ClassVar = "cohesive law"
    ability: ClassVar = "cohesive law"
    implementation: ClassVar = "gfmd_numba.interface.xu_needleman:XuNeedlemanLaw"
    normal: ClassVar = True
    tangential: ClassVar = True
    across_open_gap: ClassVar = True
    keeps_apart: ClassVar = True
    work_of_adhesion: WorkOfAdhesion
    normal_length: Length = Field(
        description="Gap of the largest attraction, in m if the scene has a length, else in L_x"
    )
    tangential_length: Length = Field(
        description="Slip at which the law has decayed to 1/e, in m if the scene has a length, else in L_x"
    )


class Friction(LawRecord):
    """Coulomb friction between touching nodes, which hold at most a limit."""

    title: ClassVar = "friction"
    ability: ClassVar = "friction"
    tangential: ClassVar = True
    needs_touching_nodes: ClassVar = True
    keeps_apart: ClassVar = False
    coefficient: FrictionCoefficient
    limit: Pressure | None = Field(
        None, description="Largest tangential traction in Pa (E* without moduli), the shear strength; None: no limit"
    )
    pressure_coefficient: float | None = Field(
        None,
        ge=0,
        description="What the limit rises by over the pressure, as shear strengths of films do (dimensionless)",
    )
    velocity_strengthening: float | None = Field(
        None,
        gt=0,
        le=10,
        description="a of a coefficient that rises by a ln(1 + v / reference_velocity) with the slip rate v; None: it "
        "does not (dimensionless)",
    )
    reference_velocity: Speed | None = Field(
        None, description="Slip rate in m/s (L_x/s without a length) far below which the coefficient is that at rest"
    )
    slip_rates: tuple[Speed, ...] = Field(
        (), strict=False, description="Rising slip rates in m/s (L_x/s without a length) at which the coefficients are"
    )
    coefficients: tuple[Annotated[float, Field(ge=0, le=100)], ...] = Field(
        (),
        strict=False,
        description="Coefficients at the slip_rates, linear in between from the coefficient at rest on and constant "
        "above (dimensionless)",
    )

    function: FunctionOfNodes | None = Field(
        None,
        description="In Python, the limit in Pa as a function of the gaps in m, which are 0, pressures in Pa and slip "
        "rates in m/s of touching nodes, all arrays; None: no such limit",
    )

    @property
    def depends_on_rate(self) -> bool:
        """Whether it needs to know how fast nodes slip."""
        return self.velocity_strengthening is not None or bool(self.slip_rates) or self.function is not None

    @model_validator(mode="after")
    def _rates(self) -> Self:
        if (self.velocity_strengthening is None) != (self.reference_velocity is None):
            raise broken_rule((), "both of velocity_strengthening and reference_velocity, or none")
        if self.velocity_strengthening is not None and self.slip_rates:
            raise broken_rule(("slip_rates",), "one of velocity_strengthening and a table of slip_rates")
        if len(self.slip_rates) != len(self.coefficients):
            raise broken_rule(("coefficients",), "as many coefficients as slip_rates")
        if any(after <= before for before, after in pairwise(self.slip_rates)):
            raise broken_rule(("slip_rates",), "slip rates that rise")
        if self.depends_on_rate and isinf(self.coefficient):
            raise broken_rule(("coefficient",), "a finite coefficient where friction depends on the slip rate")
        return self

    @model_validator(mode="after")
    def _limits(self) -> Self:
        if self.function is not None and self.limit is not None:
            raise broken_rule(("limit",), "one of limit and function")
        if self.pressure_coefficient and (self.limit is None or self.pressure_coefficient >= self.coefficient):
            allowed = (
                "nothing without a limit, which it raises, and less than the coefficient, which it does not replace"
            )
            raise broken_rule(("pressure_coefficient",), allowed)
        if self.limit is not None and isinf(self.coefficient):
            raise broken_rule(("limit",), "no limit with an infinite coefficient, under which touching nodes stick")
        return self


class Wear(BaseModel):
    """Archard's law: the depth that wears off the punch is rate times pressure times sliding distance."""

    model_config = RECORD
    rate: WearRate = Field(description="Depth over pressure and sliding distance in m^2/N (1/E* without moduli)")


Law = (
    HardWall | Exponential | SquaredExponential | PowerLawOfTheGap | MaugisDugdale | LennardJones | Cohesive | Friction
)


class Interface(BaseModel):
    """Interaction between body and punch; an absent one is None."""

    model_config = RECORD
    hard_wall: HardWall | None = Field(None, description="Non-overlap constraint")
    exponential: Exponential | None = Field(None, description="Finite-range attraction or repulsion")
    squared_exponential: SquaredExponential | None = Field(
        None, description="Attraction that is largest at a gap, and none at no gap"
    )
    power_law: PowerLawOfTheGap | None = Field(None, description="Attraction or repulsion by a power of the distance")
    maugis_dugdale: MaugisDugdale | None = Field(None, description="Constant attraction up to a range")
    lennard_jones: LennardJones | None = Field(None, description="Attraction and repulsion of half-spaces of atoms")
    cohesive: Cohesive | None = Field(None, description="Attraction, repulsion and resistance to slip in one law")
    friction: Friction | None = Field(None, description="Tangential tractions on touching nodes")
    wear: Wear | None = Field(None, description="Loss of material of the punch where it slides")

    @property
    def laws(self) -> dict[str, Law]:
        """The laws that act, by name."""
        return {name: law for name, law in self if isinstance(law, Law)}

    @property
    def keeps_apart(self) -> bool:
        """Whether something keeps the bodies apart."""
        return any(law.keeps_apart for law in self.laws.values())

    @property
    def law_of_the_gap(self) -> LawOfTheGap | None:
        """The law of the gap alone that acts."""
        return next((law for law in self.laws.values() if isinstance(law, LawOfTheGap)), None)

    @property
    def touches(self) -> bool:
        """Whether nodes can touch: under a pattern also those at which a law that leaves a gap does not act."""
        law = self.law_of_the_gap
        return law is None or not law.leaves_a_gap or law.pattern is not None

    @property
    def hardness(self) -> float | None:
        """Largest pressure of the hard wall in Pa (E* without moduli)."""
        return None if self.hard_wall is None else self.hard_wall.hardness

    @property
    def couples(self) -> bool:
        """Whether tangential tractions act."""
        return any(law.tangential for law in self.laws.values())

    @property
    def attracts(self) -> bool:
        """Whether a law attracts."""
        return any(getattr(law, "work_of_adhesion", 0.0) > 0.0 for law in self.laws.values())

    @property
    def reaches_across(self) -> bool:
        """Whether anything acts across an open gap."""
        return any(law.across_open_gap for law in self.laws.values())

    @model_validator(mode="after")
    def _laws_agree(self) -> Self:
        for name, law in self.laws.items():
            if law.needs_touching_nodes and self.hard_wall is None:
                raise broken_rule((name,), f"{name} with a hard_wall, on which there are touching nodes")
            if isinstance(law, LawOfTheGap) and law.pattern is not None and self.hard_wall is None:
                raise broken_rule((name, "pattern"), "a hard_wall with it, for nodes at which nothing repels")
        return self


_RECORDS = {name: get_args(field.annotation)[0] for name, field in Interface.model_fields.items()}
LAWS: dict[str, type[Law]] = {name: record for name, record in _RECORDS.items() if issubclass(record, LawRecord)}
LAWS_OF_THE_GAP = {name for name, law in LAWS.items() if issubclass(law, LawOfTheGap)}
