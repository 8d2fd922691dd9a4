#!/usr/bin/env python3
"""Makes jelly-on-spoon.json, a trial after Fig. 11 of Pungotra et al. (2013): a helping of soft gelatin, 28 x 22 x 14 mm,
is lowered into the bowl of a steel spoon, which then tilts about an axis across the spoon. A positive angle lifts the
rim that is away from the handle.

Usage: jelly_on_spoon.py > jelly-on-spoon.json
"""
from documents import model, write
from helping import trial

FRICTION = 0.1  # a choice: no trustworthy coefficient of gelatin on steel is published

bowl = model("spoon-bowl")["body"]
spoon = {"name": "spoon", "surface": bowl["surface"], "rim_uv": bowl["rim_uv"], "material": "steel-304"}
LATTICE = {"nodes": [12, 6, 10], "cells": "box"}  # no cell is flat, so a tick takes few substeps

write(trial("jelly-on-spoon", LATTICE, (134.0, 9.0, 0.0), spoon, (134.0, 0.0, 0.0), FRICTION))
