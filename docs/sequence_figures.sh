#!/bin/sh
# Remakes the pictures of docs/sequences.md. Run it from the repository's root, or `make figures`. AUREOLE names the
# command, PYTHON the interpreter, if they are not on the path.
set -eu
AUREOLE=${AUREOLE:-aureole}
PYTHON=${PYTHON:-python3}
TO=docs/pictures
TEMP=$(mktemp -d)
trap 'rm -rf "$TEMP"' EXIT

# A lamp behind a railing, all of its 48 frames.
$AUREOLE lights glare railing -o "$TEMP/railing.####.exr" --samples 5 --contact-sheet "$TEMP/sheet.png"
$PYTHON docs/sequence_pictures.py smaller $TO/sequence-railing.jpg "$TEMP/sheet.png"

# The page's shot: its lights keep their numbers.
$PYTHON docs/sequence_pictures.py shot "$TEMP" 48
$AUREOLE lights track "$TEMP/shot.####.exr" --frames 1001-1048 -o "$TEMP/tracks.jsonl" --most 24 \
    --preview "$TEMP/look.####.png"
$PYTHON docs/sequence_pictures.py stack $TO/sequence-lights.jpg 640x150+300+180 \
    "$TEMP/look.1001.png" "$TEMP/look.1024.png" "$TEMP/look.1048.png"

# Dirt, lashes, and openings that the housing crops.
AUREOLE=$AUREOLE PYTHON=$PYTHON sh docs/sequence_dirt.sh

# Bloom beside the full convolution.
AUREOLE=$AUREOLE PYTHON=$PYTHON sh docs/sequence_bloom.sh
