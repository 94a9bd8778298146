"""How far cheap ways of occlusion are from the exact spread, on frames of the preset "railing".

    python benchmarks/occlusion_guess.py

The exact one sums the lamp's points, each with its own view past the bars. Beside it: the whole iris, which
is what stays where a picture's own pixels cannot show bars as blurred as these; and a sharp matte of the
bars laid over the iris, seen from the lamp's middle (quad paper, section 4.4). Printed is the difference of
the glare beyond two pixels, summed, over the sum of the exact one; and what part of the lamp is visible.
"""

from dataclasses import replace

import numpy as np

from aureole import aperture, glare, jobs, light
from aureole.glare.camera import pupil
from aureole.glare.kernel import beyond_core
from aureole.jobs.scene import scene_at

FRAMES = (4, 6, 10, 15, 17, 20)
SHAPE = (301, 301)
RASTER = 1024
# Of this camera with hardly any opening, what stands before it is sharp.
PINHOLE = 200


def luminance(pixels):
    """Return the luminance beyond the core."""
    return (pixels * beyond_core(SHAPE, 2.0)[..., None]) @ light.SPACES["rec709"].to_xyz[1]


def by_matte(scene):
    """Return the glare and the visible part by a sharp matte of the occluders over the iris."""
    camera, lamp = scene.camera, scene.lamps[0]
    occluders = [each.occluder for each in scene.occluders]
    sharp = replace(camera, f_number=camera.f_number * PINHOLE)
    passes = glare.visibility(sharp, occluders)
    place = tuple(
        tangent * camera.focal_length / pitch + count // 2 + 0.5
        for tangent, pitch, count in zip(
            lamp.light.toward, camera.pixel_pitch[::-1], camera.resolution[::-1], strict=True
        )
    )
    iris = pupil(camera)
    radius = glare.neighbourhood_radius(camera, iris, occluders[0].distance)
    opening = glare.cropped_opening(iris, passes, place, radius, RASTER)
    if opening is None:
        return np.zeros(SHAPE), 0.0
    seen = replace(camera, iris=opening)
    pixels = glare.camera_psf(seen, SHAPE, light.illuminant("A"), border_fade=0.0).pixels
    return luminance(pixels), aperture.energy(opening) / aperture.area(iris)


def main() -> None:
    file = jobs.read_scene("railing")
    lamp = light.illuminant("A")
    print("frame  visible: exact  matte   difference: whole iris  matte")
    for frame in FRAMES:
        scene = scene_at(file, frame)
        occluders = [each.occluder for each in scene.occluders]
        exact = glare.area_psf(scene.camera, scene.lamps[0].light, occluders, SHAPE, lamp, across=9)
        truth = luminance(exact.psf.pixels / exact.visible)
        whole = luminance(glare.camera_psf(scene.camera, SHAPE, lamp, border_fade=0.0).pixels)
        guess, visible = by_matte(scene)
        far = [np.abs(each - truth).sum() / truth.sum() for each in (whole, guess)]
        print(f"{frame:5d}  {exact.visible:14.3f}  {visible:5.3f}  {far[0]:22.2f}  {far[1]:5.2f}", flush=True)


if __name__ == "__main__":
    main()
