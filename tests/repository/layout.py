"""Which folder may include which, read from the CMake files, and what is included in truth."""

import re
from pathlib import PurePosixPath

# What the design forbids, whatever the CMake files say: (folder, folder that it must not reach, why).
FORBIDDEN = (
    ("noise", "warp", "the air knows no pictures"),
    ("noise", "reference", "the air knows no tracer"),
    ("warp", "reference", "the warp is what the tracer judges"),
    ("reference/trace", "warp/displace", "the tracer shares no approximation with what it judges"),
    ("reference/trace", "warp/resample", "the tracer shares no approximation with what it judges"),
    ("reference/trace", "warp/shimmer", "the tracer shares no approximation with what it judges"),
)


class Library:
    def __init__(self, name, folder, links, program):
        self.name, self.folder, self.program = name, folder, program
        self.public, self.private = list(links), []


def _cmake(tree, file):
    """The text of a CMake file without comments, its foreach loops over words written out."""
    text = re.sub(r"#.*", "", tree.text(file))
    return re.sub(r"foreach\((\w+) ([\w ]+)\)(.*?)endforeach\(\)",
                  lambda loop: "".join(loop[3].replace("${" + loop[1] + "}", word) for word in loop[2].split()), text, flags=re.S)


def _declared(tree):
    """(name, folder, links, program) of every library of a folder, kind of medium, and program made of a folder's files."""
    for file in tree.files:
        if not file.endswith("CMakeLists.txt"):
            continue
        text = _cmake(tree, file)
        yield from ((name, folder, [], False) for name, folder in re.findall(r"^\s*eikonal_library\(\s*(\w+)\s+([\w/]+)", text, re.M))
        for kind, links in re.findall(r"^\s*eikonal_medium\(\s*(\w+)([^)]*)\)", text, re.M):
            yield f"noise_{kind}", f"noise/{kind}", ["noise_medium", *links.split()], False
        sources = dict(re.findall(r"file\(GLOB (\w+) CONFIGURE_DEPENDS (\w+)/\*\.cpp\)", text))
        for name, variable in re.findall(r"add_executable\(\s*([\w-]+)\s+\$\{(\w+)\}\)", text):
            if variable in sources:
                yield name, str(PurePosixPath(file).parent / sources[variable]), [], True


def read_libraries(tree):
    """Libraries and programs by name, with what `target_link_libraries(NAME PUBLIC ... PRIVATE ...)` links to them."""
    libraries = {}
    for name, *rest in _declared(tree):
        libraries[name] = Library(name, *rest)
    cmake = "\n".join(_cmake(tree, f) for f in tree.files if f.endswith("CMakeLists.txt"))
    for name, arguments in re.findall(r"target_link_libraries\(\s*([\w-]+)\s+([^)]*)\)", cmake):
        if name not in libraries:
            continue
        scope = "public"
        for word in arguments.split():
            if word in ("PUBLIC", "INTERFACE", "PRIVATE"):
                scope = "private" if word == "PRIVATE" else "public"
            else:
                getattr(libraries[name], scope).append(word)
    for library in libraries.values():
        library.public = [l for l in library.public if l in libraries]
        library.private = [l for l in library.private if l in libraries]
    return libraries


def reachable(libraries, name, private):
    """Names that a library sees: itself, its links, and all that is public in them."""
    seen, waiting = {name}, libraries[name].public + (libraries[name].private if private else [])
    while waiting:
        other = waiting.pop()
        if other not in seen:
            seen.add(other)
            waiting += libraries[other].public
    return seen


def find_circle(graph):
    """A list of nodes that leads back to its first, or None. graph: node -> nodes."""
    done, path = set(), []

    def visit(node):
        if node in path:
            return path[path.index(node):] + [node]
        if node in done:
            return None
        path.append(node)
        for other in sorted(graph.get(node, ())):
            if circle := visit(other):
                return circle
        path.pop()
        done.add(node)
        return None

    for node in sorted(graph):
        if circle := visit(node):
            return circle
    return None


def includes(tree, path):
    """(line number, path) of every file of this tree that a file includes by its path from the root."""
    for number, line in enumerate(tree.lines(path), 1):
        if match := re.match(r'\s*#\s*include\s+"([^"]+/[^"]+)"', line):
            yield number, match.group(1)


def under(path, folder):
    return path == folder or path.startswith(folder + "/")


def check_links(tree):
    """The graph of libraries has no circle and no forbidden arrow."""
    libraries = read_libraries(tree)
    problems = []
    if circle := find_circle({name: set(l.public + l.private) for name, l in libraries.items()}):
        problems.append(f"CMake: {' -> '.join(circle)}: libraries link each other in a circle; move what both need to a "
                        f"folder below them")
    for name, library in libraries.items():
        for other in sorted(reachable(libraries, name, private=True)):
            for start, end, why in FORBIDDEN:
                if under(library.folder, start) and under(libraries[other].folder, end):
                    problems.append(f"CMake: {name} ({library.folder}) links {other} ({libraries[other].folder}): {why}")
    return problems


def check_folders(tree):
    """Every folder of code belongs to a library or a program that the CMake files declare."""
    known = {l.folder for l in read_libraries(tree).values()}
    folders = {str(PurePosixPath(f).parent) for f in tree.with_suffix(".h", ".cpp") if f.split("/")[0] in ("noise", "warp", "reference")}
    return [f"{folder}: no CMakeLists.txt makes it a library: eikonal_library(NAME {folder})" for folder in sorted(folders)
            if not any(under(folder, k) for k in known)]


def check_includes(tree):
    """Every included file exists, lies in a folder that the including one may see, and no files include each other in a circle."""
    libraries = read_libraries(tree)
    by_folder = {l.folder: l.name for l in libraries.values()}
    problems, graph = [], {}
    for path in tree.with_suffix(".h", ".cpp"):
        library = by_folder.get(str(PurePosixPath(path).parent))
        seen = {libraries[n].folder for n in reachable(libraries, library, path.endswith(".cpp") or libraries[library].program)
                } if library else None
        for number, other in includes(tree, path):
            folder = str(PurePosixPath(other).parent)
            if folder.split("/")[0] not in ("noise", "warp", "reference", "tests"):
                continue
            graph.setdefault(path, set()).add(other)
            if other not in tree.files:
                problems.append(f"{path}:{number}: includes {other}, which does not exist; correct the path")
            elif seen is not None and folder not in seen:
                problems.append(f"{path}:{number}: {library} does not link the library of {folder}; link it in the CMake "
                                f"file if the arrow is right, else do without {other}")
            for start, end, why in FORBIDDEN:
                if under(path, start) and under(other, end):
                    problems.append(f"{path}:{number}: {start}/ must not include from {end}/: {why}")
    if circle := find_circle(graph):
        problems.append(f"{' -> '.join(circle)}: files include each other in a circle; move what both need to a header of its own")
    return problems
