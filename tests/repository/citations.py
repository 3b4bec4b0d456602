"""What comments and documents refer to: sections of the theory, equations, files, links."""

import re
from pathlib import PurePosixPath

from tree import CODE, line_of

THEORY = "noise/PHYSICS.md"
# Between two anchors of one citation: a comma, "and" or "to", and perhaps the end of a comment's line.
_GAP = r"(?:,|\s+and|\s+to)\s*(?:\n\s*(?:///?|#)?\s*)?"
_CITATION = re.compile(r"PHYSICS\.md#[\w-]+(?:" + _GAP + r"#[\w-]+)*")
_PATH = re.compile(r"(?<![\w./\-$}*])((?:noise|warp|reference|tests|samples|\.ci)/[\w./-]*\w\.(?:h|cpp|py|sh|md|toml|gp|txt|chan))\b")
_PLACEHOLDER = re.compile(r"KIND|NAME")  # in the walks of CONTRIBUTING.md
_HEADER = re.compile(r"(?<![\w./<\-])([a-z]\w*\.h)\b(?!>)")
_TEST = re.compile(r"(?<![\w./])([a-z]\w*_test)\b(?!\.)")
_LINK = re.compile(r"\]\(([^)\s]+)\)")


def anchors_of(text):
    """Anchors of a Markdown text: those set by <a id="...">, and GitHub's of its headings."""
    named = re.findall(r'<a id="([^"]+)"></a>', text)
    slugs = [re.sub(r"[^\w\- ]", "", re.sub(r"`|\*", "", h).strip().lower()).replace(" ", "-")
             for h in re.findall(r"^#+ (.*)$", text, re.M)]
    return named, slugs


def check_theory(tree):
    """Anchors and equation numbers of the theory are unique, and its index names every section."""
    if THEORY not in tree.files:
        return [f"{THEORY} is missing: comments cite it"]
    text, problems = tree.text(THEORY), []
    named = anchors_of(text)[0]
    problems += [f"{THEORY}: anchor {a} is set twice; keep one" for a in sorted(set(named)) if named.count(a) > 1]
    numbers = re.findall(r"^ {4,}\((\d+\.\d+)\)  ", text, re.M)
    problems += [f"{THEORY}: equation ({n}) is numbered twice; renumber one" for n in sorted(set(numbers)) if numbers.count(n) > 1]
    sections = re.findall(r'<a id="([^"]+)"></a>\n##', text)
    problems += [f"{THEORY}: section {a} is not in the index at the top; add it" for a in sections if f"(#{a})" not in text]
    return problems


def check_citations(tree):
    """Every PHYSICS.md#anchor resolves, and sections are cited by anchor only."""
    anchors = set(anchors_of(tree.text(THEORY))[0]) if THEORY in tree.files else set()
    problems = []
    for path in tree.texts():
        if path.startswith("tests/repository/"):
            continue
        text = tree.text(path)
        for match in _CITATION.finditer(text):
            for anchor in re.findall(r"#([\w-]+)", match.group()):
                if anchor not in anchors:
                    problems.append(f"{path}:{line_of(text, match.start())}: PHYSICS.md#{anchor} leads nowhere; anchors are "
                                    f'the <a id="..."> of {THEORY}')
        for match in re.finditer(r"PHYSICS(?:\.md)?\s+\d+", text):
            problems.append(f"{path}:{line_of(text, match.start())}: '{match.group()}': cite PHYSICS.md#anchor, not a number")
    return problems


def check_cited_back(tree):
    """Every header that a section names after "Code:" cites that section, so that its reader finds the equations."""
    if THEORY not in tree.files:
        return []
    problems = []
    for section in re.split(r'(?=<a id="[^"]+"></a>\n## )', tree.text(THEORY))[1:]:
        anchors = anchors_of(section)[0]
        for paragraph in re.findall(r"^Code: (.*?)(?:\n\n|\Z)", section, re.M | re.S):
            for path in re.findall(r"`([\w/]+\.h)`", paragraph):
                cited = {a for c in _CITATION.findall(tree.text(path)) for a in re.findall(r"#([\w-]+)", c)} if path in tree.files else set(anchors)
                if not cited.intersection(anchors):
                    problems.append(f"{path}: {THEORY} names it in section {anchors[0]}; cite PHYSICS.md#{anchors[0]} in its comment")
    return problems


def _prose(tree):
    """(path, line number, words) of every line of the documents and of every comment of the code."""
    for path in tree.texts():
        if path.startswith("tests/repository/") or not path.endswith(CODE + (".md",)):
            continue
        for number, line in enumerate(tree.lines(path), 1):
            if path.endswith(".md"):
                yield path, number, line
            elif comment := re.search(r"//.*", line):
                yield path, number, comment.group()


def check_paths(tree):
    """Files and tests that comments and documents name exist."""
    names = {PurePosixPath(f).name for f in tree.files}
    tests = {PurePosixPath(f).stem for f in tree.files} | set(re.findall(
        r"\b(\w+_test)\b", "\n".join(tree.text(f) for f in tree.files if f.endswith("CMakeLists.txt"))))
    problems = []
    for path, number, words in _prose(tree):
        problems += [f"{path}:{number}: {name} does not exist; name the file that is meant (--write does, where one file is called so)"
                     for name in _PATH.findall(words) if not tree.exists(name) and not _PLACEHOLDER.search(name)]
        problems += [f"{path}:{number}: no header is called {name}; name the one that is meant"
                     for name in _HEADER.findall(words) if name not in names]
        problems += [f"{path}:{number}: no test is called {name}; name the one that is meant"
                     for name in _TEST.findall(words) if path.endswith(".md") and name not in tests]
    return problems


def write_paths(tree):
    """Files that were moved get their new path in comments and documents, where no other file has that name; returns what changed."""
    by_name = {}
    for file in tree.files:
        by_name.setdefault(PurePosixPath(file).name, []).append(file)
    changed = {}
    for path, number, words in _prose(tree):
        for name in _PATH.findall(words):
            now = by_name.get(PurePosixPath(name).name, [])
            if not tree.exists(name) and len(now) == 1:
                lines = changed.setdefault(path, tree.text(path).split("\n"))
                lines[number - 1] = re.sub(r"(?<![\w./])" + re.escape(name) + r"\b", now[0], lines[number - 1])
    for path, lines in changed.items():
        (tree.root / path).write_text("\n".join(lines), encoding="utf-8")
    return sorted(changed)


def check_links(tree):
    """Relative links of the documents lead to files and anchors that exist."""
    problems = []
    for path in tree.with_suffix(".md"):
        text = tree.text(path)
        for match in _LINK.finditer(text):
            target, _, anchor = match.group(1).partition("#")
            if re.match(r"\w+:", target):
                continue
            parts = []
            for part in (PurePosixPath(path).parent / target).parts if target else PurePosixPath(path).parts:
                parts = parts[:-1] if part == ".." else parts + [part] if part != "." else parts
            file = "/".join(parts)
            where = f"{path}:{line_of(text, match.start())}"
            if not tree.exists(file):
                problems.append(f"{where}: the link {match.group(1)} leads to no file")
            elif anchor and file.endswith(".md") and anchor not in sum(anchors_of(tree.text(file)), []):
                problems.append(f"{where}: {file} has no anchor #{anchor}")
    return problems
