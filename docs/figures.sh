#!/bin/sh
# Remakes the pictures of docs/far-field.md with commands alone. Run it from the repository's root, or `make figures`.
# AUREOLE names the command, if it is not on the path.
set -eu
AUREOLE=${AUREOLE:-aureole}
TO=docs/pictures
TEMP=$(mktemp -d)
trap 'rm -rf "$TEMP"' EXIT

draw() { # a picture of an aperture: NAME, then flags
    name=$1; shift
    $AUREOLE aperture "$@" -o "$TO/$name" --json
}

burst() { # the preview of a starburst: NAME, then flags
    name=$1; shift
    $AUREOLE starburst --size 480 --fade 0.1 "$@" -o "$TEMP/psf.exr" --preview "$TO/$name" --json
}

# Quads: an anti-aliased heptagon from half size, as the paper takes it, and merged across levels.
draw quads.png --size 128 --finest half --quadtree
draw quads-merged.png --size 128 --finest half --quadtree --merge

# The paper's Figure 3: a round shadow moves before a heptagon.
shadow() { $AUREOLE aperture --size 256 --finest half --shadow "$1" -o "$TEMP/$2" --json; }
shadow -0.38,-0.16,0.4 0.exr
shadow -0.13,-0.06,0.4 1.exr
shadow 0.12,0.04,0.4 2.exr
draw change-1.png --size 256 --finest half --merge --shadow -0.33,-0.14,0.4 --since "$TEMP/0.exr"
draw change-2.png --size 256 --finest half --merge --shadow -0.08,-0.04,0.4 --since "$TEMP/1.exr"
draw change-3.png --size 256 --finest half --merge --shadow 0.17,0.06,0.4 --since "$TEMP/2.exr"

# The paper's Figure 4: all wavelengths of a hexagon, each looked up by itself, in batches of four, in closed form.
for method in scaled batch coherence; do
    burst "spectrum-$method.jpg" --blades 6 --pixel-pitch 6um --method $method
done

# A point, and a disc as large as the sun.
burst point.jpg --blades 6 --pixel-pitch 20um
burst sun.jpg --blades 6 --pixel-pitch 20um --light-size 0.53deg

# The paper's Figure 5: a hexagon without dust, behind dust, behind stretched dust.
draw dust-none.png --blades 6 --size 256
draw dust-round.png --blades 6 --size 256 --dust 10% --seed 3
draw dust-stretched.png --blades 6 --size 256 --dust 10% --dust-stretch 12 --dust-angle 20 --seed 3
burst dust-none.jpg --blades 6 --pixel-pitch 6um
burst dust-round.jpg --blades 6 --pixel-pitch 6um --dust 10% --seed 3
burst dust-stretched.jpg --blades 6 --pixel-pitch 6um --dust 10% --dust-stretch 12 --dust-angle 20 --seed 3

# Scratched glass, and a telescope's vanes.
draw scratches.png --size 256 --scratches 40 --seed 2
burst scratches.jpg --pixel-pitch 6um --scratches 40 --seed 2
draw vanes.png --aperture circle --obstruction 30% --spiders 4 --spider-rotation 20 --size 256
burst vanes.jpg --aperture circle --obstruction 30% --spiders 4 --spider-rotation 20 --pixel-pitch 6um

# The page about a pupil.
$AUREOLE starburst --aperture circle --f-number 8 --obstruction 30% --spiders 4 --zernike coma-x=40nm \
    --pixel-pitch 2um -o "$TEMP/psf.exr" --report "$TO/report.jpg" --json

# The same heptagon as outlines, and as a raster whose stair steps show far out.
$AUREOLE aperture --size 256 -o "$TEMP/heptagon.png" --json
burst outlines.jpg --pixel-pitch 24um
burst raster.jpg --pixel-pitch 24um --aperture-picture "$TEMP/heptagon.png"
