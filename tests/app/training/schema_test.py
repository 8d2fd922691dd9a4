"""Tests that the schemas of tasks and hands accept what comes with the program, and that schema and program refuse
the same files: those with a missing, strange, unknown or excessive field."""
import copy
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from jsonschema import Draft202012Validator

program, root = sys.argv[1], Path(sys.argv[2])
script = root / "assets/recordings/level.script.json"


def read_schema(name):
    schema = json.loads((root / f"assets/schemas/{name}.schema.json").read_text())
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def refuses(arguments):
    """Returns whether the program refuses its arguments with one clear line."""
    ran = subprocess.run([program, "train", *map(str, arguments)], capture_output=True, text=True, timeout=60)
    assert ran.returncode in (0, 1), (arguments, ran)
    if ran.returncode == 1:
        assert len(ran.stderr.strip().splitlines()) == 1 and ran.stderr.startswith("spoonbill: "), ran.stderr
    return ran.returncode == 1


def objects(value, path=()):
    yield path, value
    for name, inner in value.items():
        if isinstance(inner, dict):
            yield from objects(inner, (*path, name))


def changes(whole, optional):
    """Yields wrong versions of a file."""
    for path, holder in objects(whole):
        def changed(field, value):
            made = copy.deepcopy(whole)
            at = made
            for step in path:
                at = at[step]
            if value is None:
                del at[field]
            else:
                at[field] = value
            return made
        yield (*path, "colour"), changed("colour", "red")
        for field, value in holder.items():
            yield (*path, field), changed(field, {"strange": None})
            if field not in optional:
                yield (*path, field), changed(field, None)
            if isinstance(value, (int, float)):
                yield (*path, field), changed(field, 1e9)
            if isinstance(value, list) and len(value) <= 3:
                yield (*path, field), changed(field, value + value)


tasks, hands = read_schema("task"), read_schema("hand")
optional_parts = {"severity", "wrist", "speed", "tremor", "grip", "bend_deg", "deviation_deg", "rotation_deg"}
tried = 0
with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "changed.json"
    for shipped in sorted((root / "assets/tasks").glob("*.json")):
        whole = json.loads(shipped.read_text())
        assert tasks.is_valid(whole), [problem.message for problem in tasks.iter_errors(whole)]
        for field in ("spoon", "dish", "block"):
            if field in whole:
                whole[field] = str((shipped.parent / whole[field]).resolve())
        for field, wrong in changes(whole, {"note", "path_mm"}):
            assert not tasks.is_valid(wrong), (shipped.name, field, "is taken by the schema")
            file.write_text(json.dumps(wrong))
            assert refuses([file, "--script", script]), (shipped.name, field, "is taken by the program")
            tried += 1
    task = root / "assets/tasks/level.json"
    for shipped in sorted((root / "assets/hands").glob("*.json")):
        whole = json.loads(shipped.read_text())
        assert hands.is_valid(whole), [problem.message for problem in hands.iter_errors(whole)]
        if shipped.stem not in ("arthritis", "essential-tremor", "weak-grip"):  # which have all parts together
            continue
        for field, wrong in changes(whole, optional_parts):
            assert not hands.is_valid(wrong), (shipped.name, field, "is taken by the schema")
            file.write_text(json.dumps(wrong))
            assert refuses([task, "--script", script, "--hand", file]), (shipped.name, field, "is taken by the program")
            tried += 1
assert tried > 150, tried
print(f"{tried} wrong files")
