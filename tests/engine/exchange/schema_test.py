"""Tests that the schema accepts the documents that the program ships and writes, and rejects those that it refuses."""
import copy
import json
import sys
from pathlib import Path

from jsonschema import Draft202012Validator

root = Path(sys.argv[1])
schema = json.loads((root / "assets/schemas/document.schema.json").read_text())
Draft202012Validator.check_schema(schema)
validator = Draft202012Validator(schema)
written = root / "tests/engine/exchange/documents"

models = sorted((root / "assets/models").glob("*.json"))
assert len(models) >= 8, models
for file in [*models, *(written / f"version-{version}.json" for version in (1, 2, 3))]:
    problems = [f"{list(problem.absolute_path)}: {problem.message[:200]}"
                for problem in validator.iter_errors(json.loads(file.read_text()))]
    assert not problems, (file, problems)


def objects(value, path=()):
    """Yields the path and value of every object in a JSON value."""
    if isinstance(value, dict):
        yield path, value
        for name, inner in value.items():
            yield from objects(inner, (*path, name))
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            yield from objects(inner, (*path, place))


def at(document, path):
    for step in path:
        document = document[step]
    return document


# Fields that are optional in a document, listed under the name of the object that holds them.
optional = {
    "": {"other_bodies", "fixing_planes", "ground", "symmetry", "view"},
    "body": {"regions", "loads", "supports", "shell_thickness_mm", "solid"},
    "surface": {"trims"},
    "material": {"hardening", "stiffening", "friction"},
    "lattice": {"feature_map", "cells"},
    "region": {"along", "around", "depth_mm"},
    "regions": {"material", "friction"},
    "supports": {"motion"},
    "tool": {"soft"},
    "sculpting": {"settles", "free", "real_time"},
    "view": {"camera", "overlays", "see_through_body", "ground_mm"},
    "camera": {"yaw_deg", "pitch_deg", "field_of_view_deg"},
}
optional["other_bodies"] = optional["body"]

tried = 0
for version in (2, 3):
    whole = json.loads((written / f"version-{version}.json").read_text())
    for path, holder in objects(whole):
        name = next((step for step in reversed(path) if isinstance(step, str)), "")
        changed = copy.deepcopy(whole)
        at(changed, path)["colour"] = "red"
        assert not validator.is_valid(changed), (path, "an unknown field is taken")
        for field, value in holder.items():
            changed = copy.deepcopy(whole)
            at(changed, path)[field] = {"strange": None}
            assert not validator.is_valid(changed), (path, field, "a strange value is taken")
            if name == "overlays" or field in optional.get(name, ()):
                continue
            changed = copy.deepcopy(whole)
            del at(changed, path)[field]
            assert not validator.is_valid(changed), (path, field, "may be missing")
            tried += 1
assert tried > 200, tried

for version in (0, 1, 2, 4, "3", None):
    assert not validator.is_valid({**whole, "spoonbill_document": version}), version
second = json.loads((written / "version-2.json").read_text())
assert not validator.is_valid({**second, "spoonbill_document": 1}), "version 1 had no trims"
assert not validator.is_valid({**second, "spoonbill_document": 3}), "version 3 has other constants"
joined = copy.deepcopy(whole)
for body in (joined["body"], *joined["other_bodies"]):
    body["solid"] = "bracket"
assert validator.is_valid(joined)
first = {**json.loads((written / "version-1.json").read_text())}
first["body"] = {**first["body"], "solid": "bracket"}
assert not validator.is_valid(first), "version 1 had no solids"
meshes = copy.deepcopy(whole)
mesh = {"vertices_mm": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
        "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]}
meshes["other_bodies"] = [{"name": "dish", "kind": "fixed", "material": whole["body"]["material"], "mesh": mesh}]
assert validator.is_valid(meshes)
for change in ({"kind": "deformable"}, {"surface": whole["body"]["surface"]}, {"shell_thickness_mm": 1},
               {"mesh": {**mesh, "triangles": [[0, 2]]}}):
    changed = copy.deepcopy(meshes)
    changed["other_bodies"][0].update(change)
    assert not validator.is_valid(changed), change
without = copy.deepcopy(whole)
without["body"]["mesh"] = mesh
assert not validator.is_valid(without), "a body has a surface or a mesh"
joined["body"]["solid"] = 1
assert not validator.is_valid(joined), "a solid has a name"
# Counts a thousand bodies with a validator that skips their contents, because it is much faster.
counting = copy.deepcopy(schema)
del counting["allOf"]
del counting["properties"]["other_bodies"]["items"]
counter = Draft202012Validator(counting)
many = {**whole, "other_bodies": 999 * whole["other_bodies"][:1]}
assert counter.is_valid(many)
many["other_bodies"].append(whole["body"])
assert not counter.is_valid(many), "a document holds 1000 bodies"
print(f"{len(models)} models, {tried} fields taken away")
