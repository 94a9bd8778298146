"""Apertures and cameras as people describe them, and the records that they mean.

Whatever is left out is taken from a preset; without a preset the camera is a full-frame one of 50 mm at
f/16 with seven straight blades.
"""

import math
from dataclasses import dataclass, replace

from aureole import aperture as apertures
from aureole import glare, picture, presets, refuse
from aureole.records import Aperture, Camera

DEFAULT_CAMERA = "full-frame-50mm-f16"
SHAPES = ("iris", "circle", "rectangle", "whirl", "picture")
# What is left out of spiders, dust and scratches: parts of the opening's width.
SPIDER_WIDTH, DUST_SCALE, SCRATCH_LENGTH, SCRATCH_WIDTH = 0.02, 0.05, 0.5, 0.004
DIRT_SIZE = 1024
# A wavefront's raster has a pixel for each eighth of the shortest wave, between these sizes; each
# wavelength is transformed, so a small one saves much time.
FINEST_STEP = 380e-9 / 8
PROBE_SIZE, SMALLEST_SIZE, LARGEST_SIZE = 256, 512, 2048
NEEDS = {
    "spider_width": ("spiders",),
    "spider_rotation": ("spiders",),
    "dust_scale": ("dust",),
    "dust_stretch": ("dust",),
    "dust_angle": ("dust",),
    "dust_speed": ("dust",),
    "dirt_drift": ("dust", "scratches"),
    "dirt_time": ("dust_speed", "dirt_drift"),
    "dirt_distance": ("dust", "scratches"),
    "lid_opening": ("eyelashes",),
}


@dataclass(frozen=True)
class Opening:
    """The shape of an opening; None leaves a value to the preset.

    Parameters
    ----------
    shape : str, optional
        One of `SHAPES`.
    blades : int, optional
        Of an iris, or arms of a whirl.
    curvature : float, optional
        Of an iris's blades, 0 straight to 1 circle.
    rotation : float, optional
        Radians, counter-clockwise as seen.
    obstruction : float, optional
        Diameter of a central disc over the opening's own, 0 <= o < 1.
    width, height : float, optional
        Size of a rectangle in metres, or `width` as the diameter of any other shape; the f-number
        sets the size where they are left out.
    picture : str, optional
        File whose white lets light through, for shape "picture".
    spiders : int, optional
        Vanes from the centre to the rim.
    spider_width : float, optional
        Breadth of a vane, metres; 2 % of the opening's width where it is left out.
    spider_rotation : float, optional
        Direction of the first vane, radians, counter-clockwise as seen.
    shadow : tuple of float, optional
        A round shadow's centre (x, y), y downward, and diameter, in parts of the opening's width.
    housing : tuple of float, optional
        The lens's round rim, which cuts the opening to a cat's eye: centre and diameter as of a shadow.
    dust : float, optional
        Part of the opening that dust touches, 0 to 1.
    dust_scale : float, optional
        Size of the largest specks, metres; 5 % of the opening's width where it is left out.
    dust_stretch, dust_angle : float, optional
        How many times longer than broad specks are, and along which direction, radians.
    scratches : int, optional
        How many scratches lie on the opening's square.
    eyelashes : int, optional
        Lashes over 6 mm of a lid, the opening being a pupil of 6 mm.
    lid_opening : float, optional
        Of the lids that they hang from, 0 closed to 1 wide open; 0.7 where it is left out.
    seed : int, optional
        Of dust, scratches and eyelashes; 1 where it is left out.
    dirt_drift : tuple of float, optional
        (x, y) by which dirt moves across the opening, metres a second.
    dust_speed : float, optional
        How fast dust changes its shape: at 1 it is another after a second.
    dirt_time : float, optional
        Seconds since dirt lay where it lies without drift.
    dirt_distance : float, optional
        How far before the pupil dust and scratches lie, metres: light from off the axis throws their
        shadow elsewhere.
    direction : tuple of float, optional
        Towards the light, radians off the axis (right, down); along the axis where it is left out.
    defocus : float, optional
        W20: optical path at the rim over that at the centre, metres.
    focus_shift : float, optional
        Defocus as the distance from the sensor to the focus, metres, positive beyond the sensor.
    zernike : tuple of (term, float), optional
        Zernike polynomials, (n, m) or names, and their root mean squares in metres of optical path.
    """

    shape: str | None = None
    blades: int | None = None
    curvature: float | None = None
    rotation: float | None = None
    obstruction: float | None = None
    width: float | None = None
    height: float | None = None
    picture: str | None = None
    spiders: int | None = None
    spider_width: float | None = None
    spider_rotation: float | None = None
    shadow: tuple[float, float, float] | None = None
    housing: tuple[float, float, float] | None = None
    dust: float | None = None
    dust_scale: float | None = None
    dust_stretch: float | None = None
    dust_angle: float | None = None
    scratches: int | None = None
    eyelashes: int | None = None
    lid_opening: float | None = None
    seed: int | None = None
    dirt_drift: tuple[float, float] | None = None
    dust_speed: float | None = None
    dirt_time: float | None = None
    dirt_distance: float | None = None
    direction: tuple[float, float] | None = None
    defocus: float | None = None
    focus_shift: float | None = None
    zernike: tuple[tuple[tuple[int, int] | str, float], ...] | None = None

    def build(self, iris: str, diameter: float | None = None, focal_length: float | None = None) -> Aperture:
        """Make the aperture; what is left out comes from the iris preset of this name.

        Parameters
        ----------
        iris : str
            Name of an iris preset, or path of its file.
        diameter : float, optional
            Metres, where `width` does not say it.
        focal_length : float, optional
            Metres; a shift of focus needs it.

        Returns
        -------
        Aperture
            At its own size where `width` or the diameter is given, else 1 m wide, to be scaled. Outlines;
            with dust, scratches or a wavefront a raster.

        Raises
        ------
        refuse.Refusal
            Where a value does not fit, or does not go with the shape.
        """
        preset = presets.load("irises", iris)
        shape = self._shape(preset.shape)
        refuse.one_of("aperture", shape, SHAPES)
        self._refuse_strangers(shape)
        rotation = math.radians(preset.rotation_deg) if self.rotation is None else self.rotation
        size = self.width if self.width is not None else diameter or 1.0
        whole = self._whole(shape, preset, rotation, size)
        if self.spiders:
            breadth = SPIDER_WIDTH * whole.width if self.spider_width is None else self.spider_width
            whole = apertures.spiders(whole, self.spiders, breadth, self.spider_rotation or 0.0)
        obstruction = preset.obstruction if self.obstruction is None else self.obstruction
        if obstruction:
            whole = apertures.obstruction(whole, obstruction)
        # What comes now must not move the disc on which the wavefront stands.
        radius = apertures.bounding_radius(whole)
        f_number = None if focal_length is None else focal_length / whole.width
        pixels = 0
        if self._is_dirty():
            # Dirt is a part of the whole opening, so that it stays the same while shadows move over it.
            pixels = self._pixels(whole, f_number, radius)
            whole = self._dirty(whole, pixels)
        whole = self._cropped(whole)
        if not self._is_bent():
            return whole
        pixels = pixels or self._pixels(whole, f_number, radius)
        return self._with_wavefront(whole, pixels, f_number, radius)

    def at_default_camera(self, iris: str | None = None) -> Aperture:
        """Make the aperture at the size that the default camera gives it, unless `width` says another.

        Parameters
        ----------
        iris : str, optional
            Iris preset for what the opening leaves out; the default camera's otherwise.

        Returns
        -------
        Aperture
            As `build` makes it.

        Raises
        ------
        refuse.Refusal
            Where a value does not fit, or does not go with the shape.
        """
        camera: presets.CameraPreset = presets.load("cameras", DEFAULT_CAMERA)
        focal_length = camera.focal_length_mm * 1e-3
        return self.build(iris or camera.iris, focal_length / camera.f_number, focal_length)

    def at(self, time: float | None = None, direction: tuple[float, float] | None = None) -> "Opening":
        """Return the opening at another time, or as light from another direction finds it.

        Parameters
        ----------
        time : float, optional
            Seconds; added to the time that it has.
        direction : tuple of float, optional
            Towards the light, radians off the axis (right, down).

        Returns
        -------
        Opening
            The same one where nothing on it moves.
        """
        moves = self.dirt_drift is not None or self.dust_speed is not None
        found = self
        if moves and time is not None:
            found = replace(found, dirt_time=(self.dirt_time or 0.0) + refuse.finite("time", time))
        if self.dirt_distance is not None and direction is not None:
            found = replace(found, direction=direction)
        return found

    def _is_dirty(self) -> bool:
        return bool(self.dust or self.scratches or self.eyelashes)

    def _is_bent(self) -> bool:
        return bool(self.defocus or self.focus_shift or self.zernike)

    def _pixels(self, whole: Aperture, f_number: float | None, radius: float) -> int:
        """Return a raster's size on which a wavefront rises gently from pixel to pixel."""
        if not self._is_bent():
            return DIRT_SIZE if whole.mask is None else len(whole.mask)
        probe = self._with_wavefront(whole, PROBE_SIZE, f_number, radius)
        wanted = PROBE_SIZE * apertures.steepest_step(probe) / FINEST_STEP
        size = SMALLEST_SIZE
        while size < wanted and size < LARGEST_SIZE:
            size *= 2
        return size

    def _cropped(self, whole: Aperture) -> Aperture:
        """Leave what the lens's rim and a shadow do not cover."""
        if self.housing is not None:
            x, y, diameter = (part * whole.width for part in self.housing)
            whole = apertures.cats_eye(whole, diameter, (x, y))
        if self.shadow is not None:
            x, y, diameter = (part * whole.width for part in self.shadow)
            whole = apertures.shadow(whole, x, y, diameter)
        return whole

    def _shift(self) -> tuple[float, float] | None:
        """Return by how much the shadow of dirt is moved on the pupil, None where it cannot move."""
        if self.dirt_drift is None and self.dirt_distance is None:
            return None
        drift, time = self.dirt_drift or (0.0, 0.0), self.dirt_time or 0.0
        aside = apertures.parallax(self.direction or (0.0, 0.0), self.dirt_distance or 0.0)
        return drift[0] * time + aside[0], drift[1] * time + aside[1]

    def _dirty(self, whole: Aperture, size: int) -> Aperture:
        """See the opening through its dust, its scratches and its lashes."""
        seed = 1 if self.seed is None else self.seed
        shift, age = self._shift(), (self.dust_speed or 0.0) * (self.dirt_time or 0.0)
        if self.dust:
            scale = DUST_SCALE * whole.width if self.dust_scale is None else self.dust_scale
            stretch = 1.0 if self.dust_stretch is None else self.dust_stretch
            whole = apertures.dust(
                whole,
                size,
                self.dust,
                scale,
                seed,
                stretch,
                self.dust_angle or 0.0,
                age,
                shift=shift or (0.0, 0.0),
            )
        if self.scratches:
            length, width = SCRATCH_LENGTH * whole.width, SCRATCH_WIDTH * whole.width
            whole = apertures.scratches(whole, size, self.scratches, length, width, seed, shift=shift)
        if self.eyelashes:
            lids = apertures.LID_OPENING if self.lid_opening is None else self.lid_opening
            whole = apertures.eyelashes(whole, size, self.eyelashes, seed, lids)
        return whole

    def _with_wavefront(self, whole: Aperture, size: int, f_number: float | None, radius: float) -> Aperture:
        terms: dict[tuple[int, int] | str, float] = {}
        for term, rms in self.zernike or ():
            pair = apertures.zernike_pair(term)
            terms[pair] = terms.get(pair, 0.0) + rms
        shift = self.focus_shift or 0.0
        return apertures.with_wavefront(whole, size, terms, self.defocus or 0.0, shift, f_number, radius)

    def _shape(self, preset_shape: str) -> str:
        """Infer the shape from what is given, else from the preset."""
        if self.shape is not None:
            return self.shape
        if self.picture is not None:
            return "picture"
        if self.blades is not None or self.curvature is not None:
            return "iris"
        return preset_shape

    def _refuse_strangers(self, shape: str) -> None:
        """Refuse values that the shape has no use for."""
        uses = {
            "blades": ("iris", "whirl"),
            "curvature": ("iris",),
            "height": ("rectangle",),
            "picture": ("picture",),
        }
        for name, shapes in uses.items():
            if getattr(self, name) is not None and shape not in shapes:
                raise refuse.Refusal(
                    f"'{name}' does not go with aperture '{shape}'; it is for {' or '.join(shapes)}."
                )
        for name, needed in NEEDS.items():
            if getattr(self, name) is not None and not any(getattr(self, one) for one in needed):
                others = "' or '".join(needed)
                raise refuse.Refusal(f"'{name}' needs '{others}'.")
        if self.rotation and shape == "picture":
            raise refuse.Refusal("'rotation' does not go with aperture 'picture'; turn the picture itself.")

    def _whole(self, shape: str, preset: presets.IrisPreset, rotation: float, size: float) -> Aperture:
        """Make the opening without its obstruction."""
        if shape == "circle":
            return apertures.circle(size)
        if shape == "rectangle":
            if self.width is None or self.height is None:
                raise refuse.Refusal("aperture 'rectangle' needs 'width' and 'height', such as 2mm and 1mm.")
            return apertures.rotated(apertures.rectangle(self.width, self.height), rotation)
        if shape == "whirl":
            return apertures.whirl(size, 5 if self.blades is None else self.blades, rotation)
        if shape == "picture":
            if self.picture is None:
                raise refuse.Refusal("aperture 'picture' needs the file: --aperture-picture FILE.")
            return apertures.from_picture(picture.read(self.picture), size)
        blades = preset.blades if self.blades is None else self.blades
        curvature = preset.curvature if self.curvature is None else self.curvature
        return apertures.iris(blades, size, curvature, rotation)


@dataclass(frozen=True)
class Optics:
    """A camera as people describe it; None leaves a value to the preset.

    Parameters
    ----------
    opening : Opening
        The iris's shape.
    preset : str, optional
        Name of a camera preset, or path of its file.
    iris : str, optional
        Name of an iris preset, or path of its file.
    focal_length, f_number : float, optional
        Metres, and focal length over diameter.
    sensor_width, sensor_height : float, optional
        Metres.
    """

    opening: Opening = Opening()
    preset: str | None = None
    iris: str | None = None
    focal_length: float | None = None
    f_number: float | None = None
    sensor_width: float | None = None
    sensor_height: float | None = None

    def at(self, time: float | None = None, direction: tuple[float, float] | None = None) -> "Optics":
        """Return the camera with its opening at another time, or as another direction's light finds it.

        Parameters
        ----------
        time : float, optional
            As in `Opening.at`.
        direction : tuple of float, optional
            As in `Opening.at`.

        Returns
        -------
        Optics
            The same otherwise.
        """
        return replace(self, opening=self.opening.at(time, direction))

    def camera(
        self,
        resolution: tuple[int, int] | None = None,
        pixel_aspect: float = 1.0,
        pixel_pitch: float | None = None,
    ) -> Camera:
        """Make the camera.

        Parameters
        ----------
        resolution : tuple of int, optional
            (rows, columns) of a picture that spans the sensor's width; the preset's own otherwise.
        pixel_aspect : float
            Width of a pixel over its height.
        pixel_pitch : float, optional
            Width of a pixel in metres, in place of the sensor's.

        Returns
        -------
        Camera
            Its iris and f-number as described.

        Raises
        ------
        refuse.Refusal
            Where a value does not fit.
        """
        preset: presets.CameraPreset = presets.load("cameras", self.preset or DEFAULT_CAMERA)
        focal_length = _given("focal_length", self.focal_length, preset.focal_length_mm * 1e-3)
        if self.opening.width is not None and self.f_number is not None:
            raise refuse.Refusal("'width' and 'f_number' both set the opening's size; give one of them.")
        f_number = _given("f_number", self.f_number, preset.f_number)
        iris = self.opening.build(self.iris or preset.iris, focal_length / f_number, focal_length)
        if self.opening.width is not None:
            f_number = focal_length / iris.width
        width = _given("sensor_width", self.sensor_width, preset.sensor_width_mm * 1e-3)
        height = _given("sensor_height", self.sensor_height, preset.sensor_height_mm * 1e-3)
        rows, columns = resolution or (preset.rows, preset.columns)
        refuse.positive("pixel_aspect", pixel_aspect)
        if pixel_pitch is not None:
            width = refuse.positive("pixel_pitch", pixel_pitch) * columns
        if resolution or pixel_pitch:
            height = width / columns / pixel_aspect * rows
        return glare.camera(focal_length, f_number, iris, width, height, (rows, columns))


def _given(name: str, value: float | None, otherwise: float) -> float:
    return otherwise if value is None else refuse.positive(name, value)
