"""The one union of rough surfaces: of a punch, of a body, of campaigns and of `gfmd surface`.

Lengths are in m if the file gives a length L_x, and in L_x otherwise. The union at the end is the table: a record says
itself what makes its surfaces.
"""

from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BaseModel, BeforeValidator, Field, model_validator

from gfmd_numba.scene.measured_record import Measured
from gfmd_numba.scene.quantities import RECORD, Anisotropy, Hurst, Length, Points, RmsGradient, broken_rule
from gfmd_numba.scene.units import in_unit_of

PositiveHurst = Annotated[float, Field(ge=0.01, le=1, description="Hurst exponent (dimensionless)")]


class Random(BaseModel):
    """Random surface with either an rms height or an rms gradient.

    `implementation` names the function that makes its generator, a `gfmd_numba.roughness.generators.Generator`, of the
    record, the discretisation or None, the period in the unit of the record's lengths, the dimension and the number nx
    of grid points; it raises ValueError for a record that describes no surface.
    """

    model_config = RECORD
    implementation: ClassVar[str]
    of_maps: ClassVar[bool] = False  # whose two directions differ
    rms_height: Length | None = Field(None, description="Rms height in m, or in L_x without a length")
    rms_gradient: RmsGradient | None = Field(None, description="Root-mean-square gradient (dimensionless)")
    scaling: Literal["each", "ensemble"] = Field(
        "each", description="What has the rms height or gradient: each surface, or the ensemble by theory"
    )
    points: Points | None = Field(None, description="Grid points over L_x; None: those of the discretisation")
    cut_on: Length | None = Field(
        None, description="Shortest wavelength; None: that of the discretisation, or the shortest below Nyquist"
    )

    @property
    def needs_discretisation(self) -> bool:
        """Whether eps_c, eps_f and eps_t have to tell its grid and wavelengths."""
        return self.points is None

    @property
    def named_by(self) -> str:
        """Key that tells this kind of surface from all others: its model, or its method if that has one only."""
        return "model" if "model" in type(self).model_fields else "method"

    @property
    def by_columns(self) -> bool:
        """Whether some waves of a map are made, and scaled, without the others in memory."""
        return False

    def longest(self, period: float) -> float:
        """Longest wavelength that has to fit the period with a whole number of waves."""
        return period

    def misfit(self, period: float) -> tuple[str, str] | None:
        """Key of the length that does not fit the grid or the period, and what is allowed there; None if all fit."""
        if self.points is None or self.cut_on is None:
            return None
        finest = period / ((self.points - 1) // 2)
        if self.cut_on < finest * (1 - 1e-9):
            least = in_unit_of(self.cut_on, finest)
            return "cut_on", f"at least {least}, the shortest wavelength below Nyquist of {self.points} points"
        if int(period / self.cut_on * (1 + 1e-9)) < period / self.longest(period) * (1 - 1e-9):
            whole = f"a whole number of waves fits the period {in_unit_of(self.cut_on, period)} with it or less"
            return "cut_on", f"a wavelength so short that {whole}"
        return None

    @model_validator(mode="after")
    def _one_scale(self) -> Self:
        if (self.rms_height is None) == (self.rms_gradient is None):
            raise broken_rule((), "exactly one of rms_height and rms_gradient")
        return self


class PowerLaw(Random):
    """Random surface that is self-affine between two wavelengths, its own or those of a discretisation."""

    least_ratio: ClassVar[int] = 1  # of the roll-off to the cut-on wavelength
    hurst: Hurst
    roll_off: Length | None = Field(None, description="Longest wavelength of the power law; None: see cut_on")

    def longest(self, period: float) -> float:
        """Roll-off wavelength."""
        return self.roll_off or period

    def misfit(self, period: float) -> tuple[str, str] | None:
        """As of all random surfaces, or a roll-off that does not fit the period."""
        if self.roll_off is not None and self.roll_off > period * (1 + 1e-9):
            return "roll_off", f"at most the period {in_unit_of(self.roll_off, period)}"
        return super().misfit(period)

    @model_validator(mode="after")
    def _wavelengths_agree(self) -> Self:
        given = {name: getattr(self, name) is not None for name in ("points", "cut_on", "roll_off")}
        if len(set(given.values())) > 1:
            missing = next(name for name, there in given.items() if not there)
            raise broken_rule((missing,), "points, cut_on and roll_off together, or none of them and a discretisation")
        if self.cut_on is None or self.roll_off is None:
            return self
        if self.cut_on >= self.roll_off or self.least_ratio * self.cut_on > self.roll_off:
            limit = "a wavelength below" if self.least_ratio == 1 else "at most half of"
            raise broken_rule(("cut_on",), f"{limit} roll_off = {in_unit_of(self.cut_on, self.roll_off)}")
        return self


class SelfAffine(PowerLaw):
    """Power law between two wavelengths, drawn from its spectral density, thesis (3.28)."""

    implementation: ClassVar = "gfmd_numba.roughness.self_affine:generator"
    method: Literal["psd"] = Field(description="How the surface is made")
    model: Literal["self_affine"] = Field("self_affine", description="Spectrum of the surface")
    plateau: bool = Field(True, description="Constant spectrum beyond the roll-off, or none")
    anisotropy: Anisotropy | None = Field(
        None, description="Correlation length of a map along y over that along x (dimensionless); None: isotropic"
    )

    @property
    def by_columns(self) -> bool:
        """Where each surface has its rms gradient, which is a sum over waves."""
        return self.rms_gradient is not None and self.scaling == "each"

    def misfit(self, period: float) -> tuple[str, str] | None:
        """As of all power laws, or an anisotropy whose longest wavelength along y does not fit the period."""
        if wrong := super().misfit(period):
            return wrong
        if self.anisotropy is None or self.roll_off is None or self.anisotropy <= period / self.roll_off * (1 + 1e-9):
            return None
        most = f"at most the period over roll_off = {period / self.roll_off:.6g}"
        return "anisotropy", f"{most}, so that the longest wavelength along y fits the period"


class Spectral(Random):
    """Random surface whose spectrum has lengths of its own, drawn by one of the spectral methods."""

    implementation: ClassVar = "gfmd_numba.roughness.model_surfaces:generator"
    method: Literal["psd", "fourier_filter"] = Field(description="How the surface is made")

    @model_validator(mode="after")
    def _has_points(self) -> Self:
        if self.points is None:
            raise broken_rule(("points",), "the number of grid points over L_x, as the model has lengths of its own")
        return self


class Correlated(Spectral):
    """Exponential or K-correlation model, thesis (3.9) to (3.14): isotropic, and perhaps with mounds (3.17)."""

    hurst: PositiveHurst
    correlation_length: Length
    mound_separation: Length | None = Field(None, description="Mean distance of mounds; None: no mounds")
    model: Literal["exponential", "k_correlation"] = Field(description="Spectrum of the surface")

    @model_validator(mode="after")
    def _mounds_fit(self) -> Self:
        if self.mound_separation is not None and self.correlation_length > self.mound_separation:
            most = in_unit_of(self.correlation_length, self.mound_separation)
            reason = "as mounds are not larger than their distance"
            raise broken_rule(("correlation_length",), f"at most mound_separation = {most}, {reason}")
        return self


class LengthAnisotropy(Spectral):
    """K-correlation model of maps with two correlation lengths, thesis (3.15).

    If both are xi, it is the k_correlation model with the correlation length xi sqrt(2H).
    """

    of_maps: ClassVar = True
    model: Literal["length_anisotropy"] = Field(description="Spectrum of the surface")
    hurst: PositiveHurst
    correlation_length_x: Length
    correlation_length_y: Length


class ScalingAnisotropy(Spectral):
    """K-correlation model of maps with two Hurst exponents and correlation lengths, thesis (3.16)."""

    of_maps: ClassVar = True
    model: Literal["scaling_anisotropy"] = Field(description="Spectrum of the surface")
    hurst_x: PositiveHurst
    hurst_y: PositiveHurst
    correlation_length_x: Length
    correlation_length_y: Length


class Recursive(PowerLaw):
    """Random midpoint displacement, thesis 3.5.1, or successive random addition, thesis 3.5.1.1.

    Both are self-affine between two wavelengths at least an octave apart.
    """

    implementation: ClassVar = "gfmd_numba.roughness.recursive:generator"
    least_ratio: ClassVar = 2
    method: Literal["midpoint_displacement", "successive_addition"] = Field(description="How the surface is made")


def _self_affine_by_default(given: Any) -> Any:
    return {"model": "self_affine", **given} if isinstance(given, dict) else given


OfSpectrum = Annotated[
    Annotated[
        SelfAffine | Correlated | LengthAnisotropy | ScalingAnisotropy,
        Field(discriminator="model", description="Spectrum of the surface"),
    ],
    BeforeValidator(_self_affine_by_default),
]
Surface = Annotated[
    OfSpectrum | Recursive | Measured, Field(discriminator="method", description="Roughness of a surface")
]
