"""Imports go one way: each room imports only from the floors below it (CONTRIBUTING.md)."""

import ast
import pathlib

import aureole

SOURCE = pathlib.Path(aureole.__file__).parent

# Rooms on one line do not import each other.
FLOORS = [
    ("records", "units", "refuse"),
    ("light", "aperture", "picture", "presets"),
    ("diffraction",),
    ("glare", "flare", "surface"),
    ("jobs",),
    ("studio", "bench"),
    ("cli",),
]
# Slow to import, and not always there.
EXTRAS = ("av", "dask", "distributed")
FLOOR_OF = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}


def room_of(path: pathlib.Path) -> str:
    return path.relative_to(SOURCE).parts[0].removesuffix(".py")


def imported_rooms(path: pathlib.Path) -> set[str]:
    """Every room of ours that a module imports, at its top or inside a function."""
    rooms = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative imports hide which room is meant"
            module = node.module or ""
            names = [f"{module}.{alias.name}" for alias in node.names]
        rooms |= {name.split(".")[1] for name in names if name.startswith("aureole.")}
    return rooms


def modules() -> list[pathlib.Path]:
    return [path for path in sorted(SOURCE.rglob("*.py")) if path.parent != SOURCE or path.stem in FLOOR_OF]


def test_every_room_has_a_floor():
    rooms = {path.name for path in SOURCE.iterdir() if path.is_dir() and not path.name.startswith("__")}
    assert rooms <= set(FLOOR_OF)


def test_imports_never_run_back_up():
    wrong = []
    for path in modules():
        room = room_of(path)
        for other in imported_rooms(path) & set(FLOOR_OF):
            same_floor_friend = FLOOR_OF[room] == 0 and FLOOR_OF[other] == 0
            if other != room and FLOOR_OF[other] >= FLOOR_OF[room] and not same_floor_friend:
                wrong.append(f"{path.relative_to(SOURCE)} imports {other}")
    assert not wrong, wrong


def test_only_kernels_depend_on_numba():
    outside = [
        str(path.relative_to(SOURCE))
        for path in modules()
        if "numba" in path.read_text(encoding="utf-8") and not path.stem.startswith("_kernels")
    ]
    assert not outside, outside


def test_libraries_of_extras_are_imported_where_they_are_used():
    """So that the command line starts as fast with them as without, and runs without."""
    at_the_top = [
        f"{path.relative_to(SOURCE)} imports {name}"
        for path in modules()
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        for name in names_of(node)
        if name.split(".")[0] in EXTRAS
    ]
    assert not at_the_top, at_the_top


def names_of(node: ast.stmt) -> list[str]:
    """What a statement imports."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    return [node.module or ""] if isinstance(node, ast.ImportFrom) else []


def test_the_rule_sees_a_wrong_arrow(tmp_path):
    bad = tmp_path / "bad.py"
    bad.write_text("def f():\n    from aureole.jobs import run\n    return run\n")
    assert imported_rooms(bad) == {"jobs"}
