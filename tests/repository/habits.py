"""Habits of the repository: length of files, top-level entries, paths of machines, lists of packages."""

import re
from pathlib import PurePosixPath

from tree import SCRIPTS, CODE, header_comment, line_of

LONGEST_FILE = 400
LONGEST_LINE = 120
TOP_LEVEL = (".ci", ".clang-format", ".clang-tidy", ".gitattributes", ".gitignore", "CMakeLists.txt", "CMakePresets.json",
             "CONTRIBUTING.md", "LICENSE", "README.md", "noise", "reference", "samples", "tests", "warp")
# What belongs to one machine or one person's tools, and to nobody who reads the repository.
FOREIGN = (
    (r"(?<![\w.}])/(?:work|farm|root|Users)/", "a path of one machine"),
    (r"(?<![\w.}])/home/\w+", "a path of one machine"),
    (r"\b(?:deb|snapshot)\.debian\.org|\bregistry\.\w+\.(?:org|com)|\bfiles\.pythonhosted\.org|\bproxy\.golang\.org|\bcrates\.io",
     "the host of a package registry"),
    (r"Co-[Aa]uthored-[Bb]y:|\bGenerated (?:with|by) \[", "the signature of a tool"),
)


def check_lengths(tree):
    """No file of code above LONGEST_FILE lines, unless its first comment states the reason after "Length:"."""
    problems = []
    for path in tree.with_suffix(*CODE, *SCRIPTS):
        count = len(tree.lines(path))
        if count > LONGEST_FILE and not path.startswith("samples/") and "Length:" not in header_comment(tree.text(path)):
            problems.append(f"{path}: {count} lines, more than {LONGEST_FILE}: split it where the subject changes, or state the "
                            f"reason in its first comment as 'Length: ...'")
    return problems


def check_lines(tree):
    """No comment of C++ beyond LONGEST_LINE columns: clang-format keeps code to them, and leaves comments alone."""
    return [f"{path}:{number}: {len(line)} characters, more than {LONGEST_LINE}: break the line"
            for path in tree.with_suffix(*CODE) for number, line in enumerate(tree.lines(path), 1)
            if len(line) > LONGEST_LINE and re.match(r"\s*//", line) and "://" not in line]


def check_top_level(tree):
    """Only the agreed entries stand at the top."""
    top = sorted({PurePosixPath(f).parts[0] for f in tree.files})
    return [f"{entry}: the top folder holds only {', '.join(TOP_LEVEL)}; move it into one of these"
            for entry in top if entry not in TOP_LEVEL]


def check_foreign(tree):
    """No machine paths, hosts of registries or signatures of tools."""
    problems = []
    for path in tree.texts():
        if path.startswith("tests/repository/"):
            continue
        for pattern, what in FOREIGN:
            for match in re.finditer(pattern, tree.text(path)):
                problems.append(f"{path}:{line_of(tree.text(path), match.start())}: '{match.group()}' is {what}; remove it")
    return problems


def check_packages(tree):
    """Packages are named in .ci/packages only."""
    problems = []
    for path in tree.texts():
        if path.startswith("tests/repository/") or path in (".ci/packages", "LICENSE"):
            continue
        text = tree.text(path)
        installs = [] if path == ".ci/install" else list(re.finditer(r"\bapt(?:-get)? install\b", text))
        for match in installs + list(re.finditer(r"(?<![\w./-])lib[a-z0-9+.-]+-dev\b", text)):
            problems.append(f"{path}:{line_of(text, match.start())}: '{match.group()}': packages are listed in .ci/packages only, and "
                            f"installed by .ci/install; refer to these")
    return problems


def check_tests(tree):
    """Every test is registered with CMake, so that ctest runs it."""
    cmake = "\n".join(tree.text(f) for f in tree.files if f.startswith("tests/") and f.endswith("CMakeLists.txt"))
    words = set(re.findall(r"\w+", cmake))
    problems = []
    for path in tree.files:
        match = re.fullmatch(r"tests/(?:.*/)?(\w+)_test\.(?:cpp|py)", path)
        if match and match.group(1) not in words and match.group(1).removeprefix("program_") not in words \
                and f"{match.group(1)}_test" not in words:
            problems.append(f"{path}: no CMakeLists.txt of tests/ names it; register it there")
    return problems
