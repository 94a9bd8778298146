#!/bin/sh
# Remakes the pictures of dirt, lashes and housings of docs/sequences.md. Run it from the repository's root, or
# `make figures`. AUREOLE names the command, PYTHON the interpreter, if they are not on the path.
set -eu
AUREOLE=${AUREOLE:-aureole}
PYTHON=${PYTHON:-python3}
TO=${TO:-docs/pictures}
TEMP=$(mktemp -d)
trap 'rm -rf "$TEMP"' EXIT

# Lashes before a round opening: the opening, its starburst, and a night that is seen through it (quad paper, Fig. 14).
LASHES="--aperture circle --eyelashes 8 --seed 3"
$AUREOLE aperture $LASHES --size 512 -o "$TEMP/opening.png"
$AUREOLE starburst $LASHES --f-number 11 --pixel-pitch 5um --size 512 -o "$TEMP/burst.exr" --preview "$TEMP/burst.png"
$PYTHON docs/sequence_pictures.py row $TO/sequence-lashes.jpg "$TEMP/opening.png" "$TEMP/burst.png"
$PYTHON docs/sequence_pictures.py shot "$TEMP" 1
$AUREOLE glare "$TEMP/shot.1001.exr" $LASHES --f-number 11 --pixel-pitch 10um --precision single \
    -o "$TEMP/night.exr" --preview "$TEMP/night.png"
$PYTHON docs/sequence_pictures.py stack $TO/sequence-lashes-night.jpg 960x400+968+20 "$TEMP/night.png"

# The ringing of an opening that the housing crops more and more (quad paper, Fig. 15).
for x in 0.15 0.3 0.45 0.6 0.75; do
    $AUREOLE nearfield --texture --blades 7 --fresnel-number 30 --illuminant D65 --size 256 --housing $x,0.1,1.05 \
        -o "$TEMP/ring-$x.exr" --preview "$TEMP/ring-$x.png"
done
$PYTHON docs/sequence_pictures.py row $TO/sequence-ringing.jpg "$TEMP"/ring-*.png

# Ghosts of a light that moves aside: each ghost's ringing is that of what the housing leaves of the iris.
for x in 06 10 14; do
    $AUREOLE flare --lens nikkor_50mm_f1_2 --light ${x}deg,4deg --f-number 1.8 --ringing 30 --crop-ringing \
        --only 4-5 --only 11-13 --illuminant D65 --size 480x320 -o "$TEMP/flare-$x.exr" --preview "$TEMP/flare-$x.png"
done
$PYTHON docs/sequence_pictures.py row $TO/sequence-ringing-flare.jpg "$TEMP"/flare-*.png

# Dust that drifts over the opening: openings and starbursts of six frames.
DUST="--blades 7 --dust 25% --dust-scale 0.5mm --scratches 6 --seed 7 --dirt-drift 2mm,0.6mm"
for k in 00 04 08 12 16 20; do
    $AUREOLE aperture $DUST --dirt-time 0.${k}s --size 192 -o "$TEMP/dust-$k.png"
    $AUREOLE starburst $DUST --dirt-time 0.${k}s --f-number 16 --pixel-pitch 6um --size 192 \
        -o "$TEMP/speck-$k.exr" --preview "$TEMP/speck-$k.png"
done
$PYTHON docs/sequence_pictures.py row "$TEMP/dust.png" "$TEMP"/dust-*.png
$PYTHON docs/sequence_pictures.py row "$TEMP/specks.png" "$TEMP"/speck-*.png
$PYTHON docs/sequence_pictures.py stack $TO/sequence-dirt.jpg all "$TEMP/dust.png" "$TEMP/specks.png"
