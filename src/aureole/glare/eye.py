"""An eye, and its state at a time: all that the glare pattern depends on, in plain numbers.

An `Eye` says what a person's eye is made of; an `EyeState` says how wide its pupil stands, how far its
lens, vitreous and lids have moved at a time. Both hold numbers only; the shapes are drawn elsewhere.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

from aureole import aperture as apertures
from aureole import presets, refuse
from aureole.glare.eye_adaptation import Luminance, adapted
from aureole.glare.eye_lids import blink, squint
from aureole.glare.eye_motion import Head, accommodation, lens_stretch, vitreous_angle
from aureole.glare.eye_pupil import (
    hippus,
    pupil_diameter,
    ritschel_diameter,
    ritschel_hippus,
)

PUPIL_MODELS = ("watson-yellott", "ritschel")
SIXTY_DEGREES = math.radians(60)
MOST_LASHES = 100


@dataclass(frozen=True)
class Eye:
    """What an eye is made of.

    Parameters
    ----------
    age : float
        Years, 1 to 120: pupil, clouding of the lens, accommodation.
    pigment : float
        CIE 135's p: 0 black, 0.5 brown, 1 green, 1.2 light blue.
    seed : int
        Not negative; the same gives the same eye and motions on every machine.
    fibre_width : float
        Of the lens fibres, metres (10.2 µm at the rim: Brown, Bron & Sparrow 1987).
    fibre_count : int, optional
        Gratings all around, in place of as many as the width allows in each shell.
    fibre_annulus : tuple of float
        Inner and outer radius of the fibres that diffract, metres on the entrance pupil.
    fibre_depth : float
        What the fibres take off the wave's amplitude where they are deepest, 0 to 1.
    particles : float
        Factor on the density of the particles in cornea, lens and vitreous.
    lashes : int
        In front of the open pupil.
    lash_spread : float
        Standard deviation of their directions about the lid's normal, radians.
    lash_width : float
        At their root, metres.
    lash_distance : float
        Before the entrance pupil, metres.
    defocus : float
        Dioptres of spectacles that would correct it: negative for a short-sighted eye. The wavefront is
        defocus · r² / 2.
    zernike : mapping
        Zernike polynomials, (n, m) or a name of `aperture.ZERNIKE_NAMES`, to root mean squares in metres
        over `zernike_diameter`.
    zernike_diameter : float
        Of the disc on which the polynomials stand, metres.
    pupil : str
        How luminance gives the pupil: "watson-yellott" or "ritschel".
    hippus : float
        Factor on the tremor of the pupil.
    name : str
        Of the preset.
    """

    age: float = 30.0
    pigment: float = 0.5
    seed: int = 1
    fibre_width: float = 10.2e-6
    fibre_count: int | None = None
    fibre_annulus: tuple[float, float] = (2.25e-3, 4.0e-3)
    fibre_depth: float = 0.18
    particles: float = 1.0
    lashes: int = 6
    lash_spread: float = math.radians(20)
    lash_width: float = 80e-6
    lash_distance: float = 12e-3
    defocus: float = 0.0
    zernike: Mapping[apertures.Term, float] = field(default_factory=dict, hash=False)
    zernike_diameter: float = 6e-3
    pupil: str = "watson-yellott"
    hippus: float = 1.0
    name: str = "standard"


STANDARD = Eye()


@dataclass(frozen=True)
class EyeState:
    """An eye at a time.

    Parameters
    ----------
    eye : Eye
        Whose state it is.
    time : float
        Seconds.
    luminance : float
        To which the eye is adapted, damped in time, cd/m².
    pupil_diameter : float
        Metres, with hippus.
    accommodation : float
        Dioptres off the mean.
    lens_stretch : float
        Relative: fibres and particles of the lens at radius r stand at r (1 + stretch).
    vitreous_angle : float
        Of the vitreous against the eye, radians, counter-clockwise as seen.
    lid_opening : float
        0 closed to 1 open: blinks times squint.
    """

    eye: Eye = STANDARD
    time: float = 0.0
    luminance: float = 1.0
    pupil_diameter: float = 5e-3
    accommodation: float = 0.0
    lens_stretch: float = 0.0
    vitreous_angle: float = 0.0
    lid_opening: float = 1.0

    @classmethod
    def at(
        cls,
        time: float,
        luminance: Luminance,
        age: float | None = None,
        field_of_view: float = SIXTY_DEGREES,
        eye: Eye = STANDARD,
        seed: int | None = None,
        binocular: bool = True,
        head: Head | None = None,
        blinking: bool = True,
        hippus: bool = True,
    ) -> "EyeState":
        """Return the state of an eye at a time.

        Parameters
        ----------
        time : float
            Seconds, not negative.
        luminance : float or callable or tuple
            Of the scene, cd/m²: a number, to which the eye is adapted; a function of the time; or
            (times, values). The last two are damped in time.
        age : float, optional
            Years; the eye's own unless given.
        field_of_view : float
            Side of the square that has the luminance, radians; 60 degrees unless given. A rectangle is as
            good as a square of its area.
        eye : Eye
            The standard eye unless given.
        seed : int, optional
            The eye's own unless given.
        binocular : bool
            Whether both eyes see the scene.
        head : callable, optional
            Time to the head's angle in radians; small motions unless given.
        blinking : bool
            Whether the lids blink; they squint in any case.
        hippus : bool
            Whether the pupil trembles.

        Returns
        -------
        EyeState
            Of an eye with this age and seed.

        Raises
        ------
        refuse.Refusal
            Where a number is outside its range.
        """
        return states([time], luminance, age, field_of_view, eye, seed, binocular, head, blinking, hippus)[0]


def states(
    times: Sequence[float],
    luminance: Luminance,
    age: float | None = None,
    field_of_view: float = SIXTY_DEGREES,
    eye: Eye = STANDARD,
    seed: int | None = None,
    binocular: bool = True,
    head: Head | None = None,
    blinking: bool = True,
    hippus: bool = True,
) -> list[EyeState]:
    """Return the states of an eye at many times, following the scene's luminance once.

    Parameters
    ----------
    times : sequence of float
        Seconds, not negative, in any order.
    luminance : float or callable or tuple
        As in `EyeState.at`.
    age : float, optional
        As in `EyeState.at`.
    field_of_view : float
        As in `EyeState.at`.
    eye : Eye
        As in `EyeState.at`.
    seed : int, optional
        As in `EyeState.at`.
    binocular : bool
        As in `EyeState.at`.
    head : callable, optional
        As in `EyeState.at`.
    blinking : bool
        As in `EyeState.at`.
    hippus : bool
        As in `EyeState.at`.

    Returns
    -------
    list of EyeState
        One for each time.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    own = replace(eye, age=eye.age if age is None else age, seed=eye.seed if seed is None else seed)
    check_eye(own)
    area_deg2 = math.degrees(refuse.between("field_of_view", field_of_view, 1e-6, 2 * math.pi)) ** 2
    found = []
    for time, level in zip(times, adapted(luminance, times).tolist(), strict=True):
        mean = _mean_diameter(own, level, area_deg2, binocular)
        dioptres = accommodation(time, mean, own.age, own.seed)
        found.append(
            EyeState(
                eye=own,
                time=float(time),
                luminance=level,
                pupil_diameter=_trembling(own, time, mean) if hippus else mean,
                accommodation=dioptres,
                lens_stretch=lens_stretch(dioptres),
                vitreous_angle=vitreous_angle(time, own.seed, head),
                lid_opening=squint(level) * (blink(time, own.seed) if blinking else 1.0),
            )
        )
    return found


def eye_named(name: str, **changes: Any) -> Eye:
    """Return an eye of the presets.

    Parameters
    ----------
    name : str
        A preset's name, such as "standard" or "ritschel-2009", or a path that ends in ".toml".
    **changes : dict
        Fields of `Eye` that shall differ.

    Returns
    -------
    Eye
        The preset's, with its changes.

    Raises
    ------
    refuse.Refusal
        Where there is no such preset or field, or a value is outside its range.
    """
    preset = presets.load("eyes", name)
    known = [part.name for part in fields(Eye)]
    for key in changes:
        if key not in known:
            raise refuse.unknown_key("Eye", key, known)
    eye = Eye(
        age=preset.age,
        pigment=preset.pigment,
        seed=preset.seed,
        fibre_width=preset.fibre_width_um / 1e6,
        fibre_count=preset.fibre_count,
        fibre_annulus=(preset.fibre_annulus_mm[0] / 1e3, preset.fibre_annulus_mm[1] / 1e3),
        fibre_depth=preset.fibre_depth,
        particles=preset.particles,
        lashes=preset.lashes,
        lash_spread=math.radians(preset.lash_spread_deg),
        lash_width=preset.lash_width_um / 1e6,
        lash_distance=preset.lash_distance_mm / 1e3,
        defocus=preset.defocus_dioptres,
        zernike={term: rms / 1e6 for term, rms in preset.zernike_um.items()},
        zernike_diameter=preset.zernike_diameter_mm / 1e3,
        pupil=preset.pupil,
        hippus=preset.hippus,
        name=name,
    )
    return check_eye(replace(eye, **changes))


def check_eye(eye: Eye) -> Eye:
    """Refuse an eye that cannot be.

    Parameters
    ----------
    eye : Eye
        Any.

    Returns
    -------
    Eye
        The same.

    Raises
    ------
    refuse.Refusal
        At the first field that is outside its range.
    """
    refuse.between("age", eye.age, 1, 120)
    refuse.between("pigment", eye.pigment, 0, 1.2)
    refuse.at_least("seed", eye.seed, 0)
    refuse.between("fibre_width", eye.fibre_width, 1e-6, 1e-3)
    if eye.fibre_count is not None:
        refuse.at_least("fibre_count", eye.fibre_count, 1)
    inner, outer = refuse.shape_of("fibre_annulus", eye.fibre_annulus, (2,))
    refuse.between("outer radius of 'fibre_annulus'", float(outer), 1e-4, 6e-3)
    refuse.between("inner radius of 'fibre_annulus'", float(inner), 0, float(outer))
    refuse.between("fibre_depth", eye.fibre_depth, 0, 1)
    refuse.between("particles", eye.particles, 0, 100)
    refuse.between("lashes", refuse.at_least("lashes", eye.lashes, 0), 0, MOST_LASHES)
    refuse.between("lash_spread", eye.lash_spread, 0, math.pi / 2)
    refuse.between("lash_width", eye.lash_width, 1e-6, 1e-3)
    refuse.between("lash_distance", eye.lash_distance, 0, 0.1)
    refuse.between("defocus", eye.defocus, -20, 20)
    refuse.between("zernike_diameter", eye.zernike_diameter, 1e-4, 2e-2)
    for term, rms in eye.zernike.items():
        apertures.zernike_pair(term)
        refuse.between("root mean square of a Zernike polynomial", rms, -1e-4, 1e-4)
    refuse.one_of("pupil", eye.pupil, PUPIL_MODELS)
    refuse.between("hippus", eye.hippus, 0, 10)
    return eye


def _mean_diameter(eye: Eye, luminance: float, area_deg2: float, binocular: bool) -> float:
    if eye.pupil == "ritschel":
        return ritschel_diameter(luminance)
    return pupil_diameter(luminance, area_deg2, eye.age, binocular)


def _trembling(eye: Eye, time: float, mean: float) -> float:
    tremble = ritschel_hippus if eye.pupil == "ritschel" else hippus
    return tremble(time, mean, eye.seed, eye.hippus)
