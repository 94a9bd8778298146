#!/bin/sh
# Remakes the pictures of docs/eye.md. Run it from the repository's root, or `make figures`. PYTHON names the
# interpreter, if it is not on the path; AUREOLE_PHOTOGRAPHS a folder with GoldenGate.exr, from
# https://github.com/AcademySoftwareFoundation/openexr-images (Tiles/): without it the photograph's pictures stay as
# they are.
set -eu
PYTHON=${PYTHON:-python3}
TO=docs/pictures

# Patterns: ages and pupils, the parts one by one, the veil beside the standard, two seconds.
$PYTHON docs/eye_pictures.py patterns $TO/eye-patterns.jpg
$PYTHON docs/eye_pictures.py front $TO/eye-front.jpg
$PYTHON docs/eye_pictures.py parts $TO/eye-parts.jpg
$PYTHON docs/eye_pictures.py veil $TO/eye-veil.png
$PYTHON docs/eye_pictures.py time $TO/eye-time.jpg

# The thesis's test cases.
$PYTHON docs/eye_scenes.py sunset $TO/eye-sunset.jpg
$PYTHON docs/eye_scenes.py stars $TO/eye-stars.jpg
$PYTHON docs/eye_scenes.py water $TO/eye-water.jpg
$PYTHON docs/eye_scenes.py sizes $TO/eye-sizes.jpg
$PYTHON docs/eye_scenes.py occlusion $TO/eye-occlusion.jpg
$PYTHON docs/eye_scenes.py colours $TO/eye-colours.jpg
$PYTHON docs/eye_scenes.py blinking $TO/eye-blinking.jpg
$PYTHON docs/eye_scenes.py moving $TO/eye-moving.jpg

# A photograph that is not in the repository.
PHOTOGRAPH=${AUREOLE_PHOTOGRAPHS:-}/GoldenGate.exr
if [ -f "$PHOTOGRAPH" ]; then
    $PYTHON docs/eye_pictures.py photograph "$PHOTOGRAPH" 30 $TO/eye-golden-gate-30.jpg
    $PYTHON docs/eye_pictures.py photograph "$PHOTOGRAPH" 70 $TO/eye-golden-gate-70.jpg
else
    echo "eye_figures.sh: GoldenGate.exr is not in AUREOLE_PHOTOGRAPHS; its two pictures stay as they are" >&2
fi
