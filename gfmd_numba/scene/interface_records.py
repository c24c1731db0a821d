"""Records of what acts between body and punch; an absent interaction is `None`."""

from typing import Self

from pydantic import BaseModel, Field, model_validator

from gfmd_numba.scene.quantities import RECORD, Signed, Size, broken_rule


class HardWall(BaseModel):
    """Non-overlap constraint, which has no parameters."""

    model_config = RECORD


class Exponential(BaseModel):
    """Finite-range law with energy -work_of_adhesion exp(-gap/range) per area."""

    model_config = RECORD
    work_of_adhesion: Signed = Field(
        description="Energy per area in J/m^2 (E* L_x without moduli and length); above 0 attracts, below 0 repels"
    )
    range: Size = Field(description="Interaction range, in m if the scene has a length, else in L_x")

    @model_validator(mode="after")
    def _acts(self) -> Self:
        if self.work_of_adhesion == 0:
            raise broken_rule(("work_of_adhesion",), "a number other than 0; leave the law out if it does nothing")
        return self


class Cohesive(BaseModel):
    """Xu and Needleman's cohesive law of gap and slip together."""

    model_config = RECORD
    work_of_adhesion: Size = Field(description="Energy per area in J/m^2 (E* L_x without moduli and length)")
    normal_length: Size = Field(
        description="Gap of the largest attraction, in m if the scene has a length, else in L_x"
    )
    tangential_length: Size = Field(description="Slip over which it shears off, in m or L_x likewise")


class Friction(BaseModel):
    """Coulomb friction between touching nodes (dimensionless)."""

    model_config = RECORD
    coefficient: float = Field(
        gt=0,
        allow_inf_nan=True,
        description="Tangential over normal traction at which a node slides; inf: it sticks where it touches",
        json_schema_extra={"allowed": "a number above 0, or .inf for sticking contact"},
    )


class Interface(BaseModel):
    """Interaction between body and punch; an absent one is None."""

    model_config = RECORD
    hard_wall: HardWall | None = Field(None, description="Non-overlap constraint")
    exponential: Exponential | None = Field(None, description="Finite-range attraction or repulsion")
    cohesive: Cohesive | None = Field(None, description="Attraction, repulsion and resistance to slip in one law")
    friction: Friction | None = Field(None, description="Tangential tractions on touching nodes")

    @property
    def reaches_across(self) -> bool:
        """Whether anything acts across an open gap."""
        return self.exponential is not None or self.cohesive is not None

    @model_validator(mode="after")
    def _keeps_apart(self) -> Self:
        repels = self.exponential is not None and self.exponential.work_of_adhesion < 0
        if self.hard_wall is None and self.cohesive is None and not repels:
            raise broken_rule(
                (),
                "hard_wall, cohesive, or an exponential law that repels: something must keep the bodies apart",
            )
        others = [name for name in ("exponential", "friction") if getattr(self, name) is not None]
        if self.cohesive is not None and others:
            raise broken_rule(
                (others[0],), f"one law of normal and tangential tractions, not {others[0]} beside cohesive"
            )
        if self.friction is not None and self.hard_wall is None:
            raise broken_rule(("friction",), "friction beside a hard_wall, on which there are touching nodes")
        return self
